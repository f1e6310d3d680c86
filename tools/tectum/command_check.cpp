// tectum check: every mistake in a circuit file.
#include <fmt/format.h>

#include <memory>

#include "compiler/diagnostics/render.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

void check(const CircuitArguments& arguments, CommandContext& context) {
  const std::optional<Compilation> compilation = compile_file(arguments, compile_options(arguments), context);
  if (!compilation) {
    return;
  }
  const CompileResult& result = compilation->result;
  if (arguments.format == "json") {
    context.out << render_json(compilation->diagnostics, result.sources) << '\n';
    return;
  }
  print_diagnostics(*compilation, context);
  if (!compilation->diagnostics.has_errors() && result.network && result.circuit) {
    context.out << fmt::format("{}: ok, {} populations, {} neurons, {} synapses\n", arguments.path,
                               result.circuit->instances.size(), result.network->neuron_count(),
                               result.network->synapses.size());
  }
}

}  // namespace

void add_check_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("check", "find every mistake in a circuit file");
  auto arguments = std::make_shared<CircuitArguments>();
  add_circuit_arguments(*command, *arguments, CircuitKinds::FileOnly);
  command->footer(
      "Exit status: 0 when there is no error (warnings may be), 1 when there is, 2 when the file cannot be read.\n\n"
      "Examples:\n"
      "  tectum check circuits/oculomotor.json\n"
      "  tectum check my_circuit.json --format json      for editors and CI\n"
      "  tectum check my_circuit.json --lesion OPN -p g_sc='0.5 nA'\n");
  command->callback([arguments, &context] { check(*arguments, context); });
}

}  // namespace tectum
