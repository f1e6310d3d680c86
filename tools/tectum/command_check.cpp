// tectum check: every mistake in a circuit file.
#include <memory>

#include "compiler/diagnostics/render.h"
#include "tools/tectum/check_report.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/provenance_text.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct CheckArguments {
  CircuitArguments circuit;
  bool shows_provenance = false;
};

void check(const CheckArguments& check_arguments, CommandContext& context) {
  const CircuitArguments& arguments = check_arguments.circuit;
  CompileOptions options = compile_options(arguments);
  options.level = OptimisationLevel::O0;  // what is said is said of the network as it is written
  const std::optional<Compilation> compilation = compile_file(arguments, options, context);
  if (!compilation) {
    return;
  }
  const CompileResult& result = compilation->result;
  const bool is_whole = !compilation->diagnostics.has_errors() && result.network && result.circuit;
  if (arguments.format == "json") {
    const std::string members = is_whole ? check_json(result, check_arguments.shows_provenance) : "";
    context.out << render_json(compilation->diagnostics, result.sources, members) << '\n';
    return;
  }
  print_diagnostics(*compilation, context);
  if (is_whole) {
    context.out << check_text(arguments.path, result);
    if (check_arguments.shows_provenance) {
      context.out << provenance_text(result);
    }
  }
}

}  // namespace

void add_check_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("check", "find every mistake in a circuit file");
  auto arguments = std::make_shared<CheckArguments>();
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOnly);
  command->add_flag("--provenance", arguments->shows_provenance,
                    "list what cites no source, and what share of the synapses that is");
  command->footer(
      "Exit status: 0 when there is no error (warnings may be), 1 when there is, 2 when the file cannot be read.\n\n"
      "Examples:\n"
      "  tectum check circuits/oculomotor.json\n"
      "  tectum check my_circuit.json --format json      for editors and CI\n"
      "  tectum check circuits/oculomotor.json --provenance\n"
      "  tectum check my_circuit.json --lesion OPN -p g_sc='0.5 nA'\n");
  command->callback([arguments, &context] { check(*arguments, context); });
}

}  // namespace tectum
