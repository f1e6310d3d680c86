// tectum export: a circuit in the formats of other simulators and tools.
#include "tools/tectum/command_export.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "tools/exchange/export_edges.h"
#include "tools/exchange/export_graph.h"
#include "tools/exchange/export_neuroml.h"
#include "tools/exchange/export_nir.h"
#include "tools/exchange/export_sonata.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct ExportArguments {
  CircuitArguments circuit;
  std::string to;
  std::string output;
  std::string grain;
};

ExportReport write_format(const ExportArguments& arguments, const CompileResult& result,
                          const ExchangeProgress& progress) {
  const Wiring wiring{*result.circuit, *result.network};
  const bool is_coarse = arguments.grain.empty() ? arguments.to == "dot" : arguments.grain == "population";
  const GraphGrain grain = is_coarse ? GraphGrain::Population : GraphGrain::Cell;
  if (arguments.to == "edges") {
    return export_edges(wiring, arguments.output, progress);
  }
  if (arguments.to == "graphml") {
    return export_graphml(wiring, grain, arguments.output, progress);
  }
  if (arguments.to == "sonata") {
    return export_sonata(result, arguments.output, progress);
  }
  if (arguments.to == "nir") {
    return export_nir(wiring, arguments.output, progress);
  }
  if (arguments.to == "neuroml") {
    return export_neuroml(wiring, arguments.output, progress);
  }
  return export_dot(wiring, grain, arguments.output, progress);
}

void print(const ExportArguments& arguments, const Network& network, const ExportReport& report,
           CommandContext& context) {
  if (arguments.circuit.format == "json") {
    const nlohmann::ordered_json json = {{"path", arguments.output},
                                         {"format", arguments.to},
                                         {"neurons", network.neuron_count()},
                                         {"synapses", network.synapses.size()},
                                         {"not_said", report.warnings}};
    context.out << json.dump(2) << '\n';
    return;
  }
  for (const std::string& warning : report.warnings) {
    context.err << "warning: " << warning << '\n';
  }
  context.out << fmt::format("{}: {} neurons, {} synapses\n", arguments.output, network.neuron_count(),
                             network.synapses.size());
}

void export_circuit(const ExportArguments& arguments, CommandContext& context) {
  if (!arguments.grain.empty() && arguments.to != "graphml" && arguments.to != "dot") {
    context.err << "tectum: --nodes goes with graphml and dot\n";
    context.exit_status = kExitUsage;
    return;
  }
  CompileOptions options = compile_options(arguments.circuit);
  options.last_stage = Stage::Elaborate;  // as written: no pass has joined or dropped a synapse
  const std::optional<Compilation> compilation = compile_file(arguments.circuit, options, context);
  if (!compilation) {
    return;
  }
  if (!compilation->result.network) {
    print_diagnostics(*compilation, context);
    return;
  }
  ExportReport report;
  {
    Progress progress(context.err, "writing " + arguments.output);
    report = write_format(arguments, compilation->result, [&](double done) { progress.update(done); });
  }
  if (!report.error.empty()) {
    context.err << fmt::format("tectum: {}\n", report.error);
    context.exit_status = report.is_refused ? kExitFailed : kExitTrouble;
    return;
  }
  print(arguments, *compilation->result.network, report, context);
}

}  // namespace

void add_export_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("export", "write a circuit in the format of another simulator or tool");
  auto arguments = std::make_shared<ExportArguments>();
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOnly);
  command->add_option("--to", arguments->to, "edges (CSV), graphml, dot, sonata, nir, neuroml")
      ->required()
      ->check(CLI::IsMember({"edges", "graphml", "dot", "sonata", "nir", "neuroml"}))
      ->type_name("FORMAT");
  command->add_option("-o,--output", arguments->output, "file to write; for sonata a folder")
      ->required()
      ->type_name("PATH");
  command->add_option("--nodes", arguments->grain, "of a graph: cell [graphml], or population [dot]")
      ->check(CLI::IsMember({"cell", "population"}))
      ->type_name("GRAIN");
  command->footer(
      "What is written is the circuit after --lesion and -p. What a format cannot say is named in a warning.\n\n"
      "Exit status: 0 when it is written, 1 when the circuit is wrong or the format cannot hold it, 2 when the file\n"
      "cannot be written.\n\n"
      "Examples:\n"
      "  tectum export circuits/oculomotor.json --to edges -o out/eye.csv      also out/eye_cells.csv, one row a cell\n"
      "  tectum export circuits/oculomotor.json --to graphml -o out/eye.graphml\n"
      "  python3 -c \"import networkx; print(networkx.read_graphml('out/eye.graphml'))\"\n"
      "  tectum export circuits/oculomotor.json --to dot -o out/eye.dot && dot -Tsvg out/eye.dot -o out/eye.svg\n"
      "  tectum export circuits/oculomotor.json --to sonata -o out/eye_sonata\n"
      "  python3 -c \"import nest; nest.SonataNetwork('out/eye_sonata/circuit_config.json',\n"
      "             'out/eye_sonata/simulation_config.json').BuildNetwork()\"\n"
      "  tectum export circuits/oculomotor.json --to nir -o out/eye.nir\n"
      "  tectum export circuits/oculomotor.json --to neuroml -o out/eye.net.nml\n"
      "  tectum export circuits/oculomotor.json --lesion OPN --to dot -o out/no_opn.dot\n");
  command->callback([arguments, &context] { export_circuit(*arguments, context); });
}

}  // namespace tectum
