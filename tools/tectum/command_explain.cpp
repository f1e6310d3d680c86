// tectum explain: the page of a diagnostic, or where a part of a circuit comes from.
#include <fmt/format.h>

#include <memory>

#include "compiler/diagnostics/pages.h"
#include "compiler/expression/expression.h"
#include "tools/tectum/explain_circuit.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct ExplainArguments {
  std::string topic;
  CircuitArguments circuit;
};

void explain_part(const ExplainArguments& arguments, CommandContext& context) {
  CompileOptions options = compile_options(arguments.circuit);
  options.last_stage = Stage::Elaborate;
  const std::optional<Compilation> compilation = compile_file(arguments.circuit, options, context);
  if (!compilation) {
    return;
  }
  if (compilation->diagnostics.has_errors() || !compilation->result.network) {
    print_diagnostics(*compilation, context);
    return;
  }
  if (const auto text = explain_name(compilation->result, arguments.topic)) {
    context.out << *text;
    return;
  }
  context.err << fmt::format("tectum explain: {} has no population or projection `{}`\n", arguments.circuit.path,
                             arguments.topic);
  if (const auto nearest = nearest_name(arguments.topic, explainable_names(compilation->result))) {
    context.err << fmt::format("    = help: did you mean `{}`?\n", *nearest);
  }
  context.exit_status = kExitFailed;
}

void list_codes(CommandContext& context) {
  for (std::size_t i = 0; i < code_count(); ++i) {
    const auto code = static_cast<Code>(i);
    const std::string_view meaning = page_of(code).meaning;
    context.out << fmt::format("{}  {}\n", code_label(code), meaning.substr(0, meaning.find(". ")));
  }
}

void explain(const ExplainArguments& arguments, CommandContext& context) {
  if (!arguments.circuit.path.empty()) {
    explain_part(arguments, context);
  } else if (arguments.topic == "codes") {
    list_codes(context);
  } else if (arguments.topic == "example") {
    context.out << example_circuit();
  } else if (const auto code = find_code(arguments.topic)) {
    context.out << page_text(*code);
  } else {
    context.err << fmt::format(
        "tectum explain: no diagnostic `{0}`\n"
        "    = help: `tectum explain codes` lists them; for a part of a circuit: `tectum explain {0} CIRCUIT`\n",
        arguments.topic);
    context.exit_status = kExitUsage;
  }
}

}  // namespace

void add_explain_command(CLI::App& app, CommandContext& context) {
  CLI::App* command =
      app.add_subcommand("explain", "the page of a diagnostic, or where a population or projection comes from");
  auto arguments = std::make_shared<ExplainArguments>();
  command->add_option("topic", arguments->topic, "a code (E0204), `codes`, `example`, or a name in CIRCUIT")
      ->required()
      ->type_name("TOPIC");
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOnly);
  command->get_option("circuit")->required(false);
  command->footer(
      "Examples:\n"
      "  tectum explain E0204                               what it means, a failing example, the mended one\n"
      "  tectum explain codes                               every code in a line\n"
      "  tectum explain EBN circuits/oculomotor.json        each value with the line that gives it, what joins it\n"
      "  tectum explain sc_llbn circuits/oculomotor.json    rule, weights, delays, synapses, sources\n");
  command->callback([arguments, &context] { explain(*arguments, context); });
}

}  // namespace tectum
