// tectum import edges: a measured wiring diagram, out of a paper's supplement, as a circuit file.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "tools/exchange/import_edges.h"
#include "tools/exchange/text_file.h"
#include "tools/tectum/command_import.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

struct ImportArguments {
  EdgeImport import;
  std::string separator;
  std::vector<std::string> driven;  // "sensories=100"
  double leading_eigenvalue_na = 0;
  bool divides_by_input = false;
};

/// "sensories", "sensories=50" or "sensories=50Hz".
std::optional<DrivenClass> driven_class(const std::string& text) {
  DrivenClass driven;
  const std::size_t equals = text.rfind('=');
  driven.name = text.substr(0, equals);
  if (equals == std::string::npos) {
    return driven;
  }
  std::string rate = text.substr(equals + 1);
  for (const char* unit : {" Hz", "Hz"}) {
    if (rate.ends_with(unit)) {
      rate.resize(rate.size() - std::string_view(unit).size());
    }
  }
  char* end = nullptr;
  driven.rate_hz = std::strtod(rate.c_str(), &end);
  const bool is_rate = !rate.empty() && *end == '\0' && driven.rate_hz > 0 && driven.rate_hz <= 1e4;
  return is_rate && !driven.name.empty() ? std::optional(driven) : std::nullopt;
}

bool complete(ImportArguments& arguments, CommandContext& context) {
  EdgeImport& import = arguments.import;
  const std::string& separator = arguments.separator;
  if (separator == "tab" || separator == "\\t") {
    import.separator = '\t';
  } else if (separator == "space") {
    import.separator = ' ';
  } else if (separator.size() <= 1) {
    import.separator = separator.empty() ? '\0' : separator.front();
  } else {
    context.err << fmt::format("tectum: --separator takes one character, `tab` or `space`, not `{}`\n", separator);
    return false;
  }
  for (const std::string& text : arguments.driven) {
    const auto driven = driven_class(text);
    if (!driven) {
      context.err << fmt::format("tectum: --drive `{}` is no CLASS or CLASS=RATE\n    = help: --drive sensories=50\n",
                                 text);
      return false;
    }
    import.driven.push_back(*driven);
  }
  import.scaling = arguments.divides_by_input ? EdgeScaling::ShareOfInput : EdgeScaling::PerSynapse;
  if (arguments.leading_eigenvalue_na > 0) {
    import.leading_eigenvalue_na = arguments.leading_eigenvalue_na;
  }
  const std::string stem = fs::path(import.edges_path).stem().string();
  import.name = import.name.empty() ? stem : import.name;
  import.output_path = import.output_path.empty() ? stem + ".json" : import.output_path;
  return true;
}

void print_failure(const ImportedEdges& imported, CommandContext& context) {
  if (imported.bad_rows.count > 0) {
    context.err << fmt::format("tectum: {} has {} bad row{}\n", imported.bad_path, imported.bad_rows.count,
                               imported.bad_rows.count == 1 ? "" : "s");
    for (const std::string& row : imported.bad_rows.named) {
      context.err << "    " << row << '\n';
    }
    if (imported.bad_rows.count > imported.bad_rows.named.size()) {
      context.err << fmt::format("    and {} more\n", imported.bad_rows.count - imported.bad_rows.named.size());
    }
    context.exit_status = kExitFailed;
    return;
  }
  context.err << fmt::format("tectum: {}\n", imported.error);
  if (!imported.help.empty()) {
    context.err << fmt::format("    = help: {}\n", imported.help);
  }
  context.exit_status = kExitTrouble;
}

void run(ImportArguments& arguments, CommandContext& context) {
  if (!complete(arguments, context)) {
    context.exit_status = kExitUsage;
    return;
  }
  ImportedEdges imported;
  {
    Progress progress(context.err, fmt::format("reading {}", arguments.import.edges_path));
    imported = import_edges(arguments.import, [&](double done) { progress.update(done); });
  }
  if (imported.text.empty()) {
    print_failure(imported, context);
    return;
  }
  TextFile file(arguments.import.output_path);
  file.write("{}", imported.text);
  if (const std::string error = file.close(); !error.empty()) {
    context.err << fmt::format("tectum: {}\n", error);
    context.exit_status = kExitTrouble;
    return;
  }
  context.out << fmt::format("{}: {} cells in {} populations, {} connections\n", arguments.import.output_path,
                             imported.cells, imported.populations.size(), imported.edges);
  context.out << fmt::format("  columns: {}\n", imported.columns);
  std::uint64_t inhibitory = 0;
  for (const ImportedPopulation& population : imported.populations) {
    inhibitory += population.is_inhibitory ? population.size : 0;
  }
  context.out << fmt::format("  {} cells inhibit\n", inhibitory);
}

}  // namespace

void add_import_edges_command(CLI::App& import, CommandContext& context) {
  CLI::App* command = import.add_subcommand("edges", "an edge list: one row a connection, in a text file with columns");
  auto arguments = std::make_shared<ImportArguments>();
  EdgeImport& o = arguments->import;
  command->add_option("edges", o.edges_path, "the edge list")->required()->type_name("FILE.csv");
  command->add_option("--cells", o.cells_path, "a table of the cells; becomes a population for each class and side")
      ->type_name("FILE.csv");
  command->add_option("-o,--output", o.output_path, "circuit file to write [the edge list's name with .json, here]")
      ->type_name("FILE");
  command->add_option("--name", o.name, "of the circuit [the edge list's name]")->type_name("NAME");
  command->add_option("--separator", arguments->separator, "between columns: a character, `tab` or `space` [found out]")
      ->type_name("C");
  command->add_option("--pre", o.pre, "column of the presynaptic cell [found out, as are the next ones]")
      ->type_name("COLUMN");
  command->add_option("--post", o.post, "column of the postsynaptic cell")->type_name("COLUMN");
  command->add_option("--weight", o.weight, "column of the weight or the number of synapses; negative weights inhibit")
      ->type_name("COLUMN");
  command->add_option("--type", o.type, "column of the type of edge: one projection for each")->type_name("COLUMN");
  command->add_option("--id", o.id, "in the table: column of the cell's name")->type_name("COLUMN");
  command->add_option("--class", o.cell_class, "in the table: column of the cell's class")->type_name("COLUMN");
  command->add_option("--side", o.side, "in the table: column of the cell's side")->type_name("COLUMN");
  command
      ->add_option("--sign", o.sign,
                   "in the table: column of the cell's sign or transmitter (-1, inhibitory, GABA, ...)")
      ->type_name("COLUMN");
  command->add_option("--inhibitory", o.inhibitory, "classes whose cells inhibit; repeatable")
      ->expected(1)
      ->take_all()
      ->type_name("CLASS");
  command
      ->add_option("--drive", arguments->driven,
                   "fire at the cells of this class with Poisson sources [100 Hz]; repeatable")
      ->expected(1)
      ->take_all()
      ->type_name("CLASS[=HZ]");
  command->add_flag("--divide-by-input", arguments->divides_by_input,
                    "weigh each edge by its share of all that arrives at its cell");
  command
      ->add_option("--leading-eigenvalue", arguments->leading_eigenvalue_na,
                   "scale all weights together to this leading eigenvalue when the circuit is compiled")
      ->check(CLI::PositiveNumber)
      ->type_name("NANOAMPERE");
  command->footer(
      "The circuit file refers to the data, which are read when it is compiled: keep them together.\n\n"
      "Examples:\n"
      "  tectum import edges edges.csv --cells cells.csv --drive sensories=50 -o larva.json\n"
      "  tectum import edges wiring.tsv --separator tab --pre from --post to --weight n\n"
      "  tectum import edges edges.csv --cells cells.csv --sign transmitter --type kind --divide-by-input\n");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace tectum
