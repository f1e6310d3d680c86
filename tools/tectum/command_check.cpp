// tectum check: every mistake in a circuit file.
#include <fmt/format.h>

#include <memory>

#include "compiler/diagnostics/render.h"
#include "compiler/elaborate/symmetry.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/provenance_text.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct CheckArguments {
  CircuitArguments circuit;
  bool shows_provenance = false;
};

constexpr std::size_t kNamesShown = 6;

/// "mirror left/right (horizontal): symmetric", or what breaks it.
std::string symmetry_text(const CompileResult& result) {
  std::string text;
  for (const SymmetryVerdict& verdict : mirror_symmetry(*result.circuit, *result.network)) {
    text += fmt::format("  mirror {} ({}): ", verdict.sides, verdict.axes);
    if (verdict.is_symmetric()) {
      text += "symmetric\n";
      continue;
    }
    text += fmt::format("{} of {} synapses without a mirror image; broken by ", verdict.unmatched_synapses,
                        result.network->synapses.size());
    const std::size_t shown = std::min(kNamesShown, verdict.broken_by.size());
    text += fmt::format("{}", fmt::join(verdict.broken_by.begin(),
                                        verdict.broken_by.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
    text += shown < verdict.broken_by.size() ? fmt::format(" and {} more\n", verdict.broken_by.size() - shown) : "\n";
  }
  return text;
}

void check(const CheckArguments& check_arguments, CommandContext& context) {
  const CircuitArguments& arguments = check_arguments.circuit;
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
    context.out << symmetry_text(result);
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
