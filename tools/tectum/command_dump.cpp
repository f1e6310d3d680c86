// tectum dump: what a stage of the compiler made, or what an image's bytes mean.
#include <fmt/format.h>

#include <limits>
#include <memory>

#include "runtime/image/describe_image.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct DumpArguments {
  CircuitArguments circuit;
  std::string stage;
  std::string pass;
  bool in_full = false;
};

constexpr std::size_t kSynapsesShown = 40;

void dump_image(const DumpArguments& arguments, CommandContext& context) {
  const std::optional<SpikeImage> image = load_circuit(arguments.circuit, context, WarningPolicy::Quiet);
  if (image) {
    context.out << describe_image(*image, {.in_full = arguments.in_full});
  }
}

void dump_compilation(const DumpArguments& arguments, CommandContext& context) {
  const std::optional<Stage> stage = find_stage(arguments.stage);
  CompileOptions options = compile_options(arguments.circuit);
  options.last_stage = stage.value_or(Stage::Lower);
  options.last_pass = arguments.pass;
  const std::optional<Compilation> compilation = compile_file(arguments.circuit, options, context);
  if (!compilation) {
    return;
  }
  if (compilation->diagnostics.has_errors()) {
    print_diagnostics(*compilation, context);
    return;
  }
  const std::size_t shown = arguments.in_full ? std::numeric_limits<std::size_t>::max() : kSynapsesShown;
  context.out << dump_stage(compilation->result, options.last_stage, shown);
}

void dump(const DumpArguments& arguments, CommandContext& context) {
  if (!arguments.pass.empty() && arguments.stage != "optimise") {
    context.err << "tectum: --after goes with the stage optimise\n";
    context.exit_status = kExitUsage;
  } else if (arguments.stage == "image") {
    dump_image(arguments, context);
  } else {
    dump_compilation(arguments, context);
  }
}

std::vector<std::string> pass_names() {
  std::vector<std::string> names;
  for (const PassInfo& pass : all_passes()) {
    names.emplace_back(pass.name);
  }
  return names;
}

}  // namespace

void add_dump_command(CLI::App& app, CommandContext& context) {
  CLI::App* command =
      app.add_subcommand("dump", "show what a stage of the compiler made, or what an image's bytes mean");
  auto arguments = std::make_shared<DumpArguments>();
  command->add_option("stage", arguments->stage, "json, decl, circuit, network, optimise or image")
      ->required()
      ->check(CLI::IsMember({"json", "decl", "circuit", "network", "optimise", "image"}))
      ->type_name("STAGE");
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOrImage);
  command->add_option("--after", arguments->pass, "with optimise: show the network after this pass")
      ->check(CLI::IsMember(pass_names()))
      ->type_name("PASS");
  command->add_flag("--full", arguments->in_full, "print every synapse and every record");
  command->footer(
      "Examples:\n"
      "  tectum dump network circuits/oculomotor.json          neurons and synapses, each with its origin\n"
      "  tectum dump optimise circuits/oculomotor.json --after merge_parallel_synapses\n"
      "  tectum dump image out/oculomotor.image                the meaning of the image's bytes\n");
  command->callback([arguments, &context] { dump(*arguments, context); });
}

}  // namespace tectum
