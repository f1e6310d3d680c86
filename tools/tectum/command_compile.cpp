// tectum compile: a circuit file to a spike image.
#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>

#include "compiler/diagnostics/render.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct CompileArguments {
  CircuitArguments circuit;
  std::string output;
  bool prints_stats = false;
};

std::string default_output(const std::string& circuit) {
  return std::filesystem::path(circuit).replace_extension(".image").filename().string();
}

void print_stats(const Compilation& compilation, std::size_t image_bytes, CommandContext& context) {
  const CompileResult& result = compilation.result;
  context.out << fmt::format("{:<28} {:>10}\n", "stage", "ms");
  for (const StageTime& time : result.times) {
    context.out << fmt::format("{:<28} {:>10.2f}\n", time.name, time.seconds * 1e3);
  }
  if (!result.passes.empty()) {
    context.out << fmt::format("\n{:<28} {:>10} {:>12} {:>12}\n", "pass", "ms", "synapses in", "out");
  }
  for (const PassStats& pass : result.passes) {
    context.out << fmt::format("{:<28} {:>10.2f} {:>12} {:>12}\n", pass.name, pass.seconds * 1e3, pass.synapses_before,
                               pass.synapses_after);
  }
  const auto synapses = result.image->targets.size();
  context.out << fmt::format("\nimage {} bytes", image_bytes);
  if (synapses > 0) {
    const auto bytes = result.image->targets.size() * 4 + result.image->weights.size() * 4 +
                       result.image->segments.size() * sizeof(SegmentRecord);
    context.out << fmt::format(", {:.2f} bytes a synapse", static_cast<double>(bytes) / static_cast<double>(synapses));
  }
  context.out << '\n';
}

void compile(const CompileArguments& arguments, CommandContext& context) {
  const std::optional<Compilation> compilation =
      compile_file(arguments.circuit, compile_options(arguments.circuit), context);
  if (!compilation) {
    return;
  }
  if (arguments.circuit.format == "json") {
    context.out << render_json(compilation->diagnostics, compilation->result.sources) << '\n';
  } else {
    print_diagnostics(*compilation, context);
  }
  if (!compilation->result.image) {
    return;
  }
  const std::string path = arguments.output.empty() ? default_output(arguments.circuit.path) : arguments.output;
  const std::vector<std::byte> bytes = write_image(*compilation->result.image);
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::filesystem::create_directories(parent, ignored);
  }
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    context.err << fmt::format("tectum: cannot write {}\n", path);
    context.exit_status = kExitTrouble;
    return;
  }
  if (arguments.circuit.format == "text") {
    context.out << fmt::format("{}: {} neurons, {} synapses, {} bytes\n", path, compilation->result.image->neuron_count,
                               compilation->result.image->targets.size(), bytes.size());
    if (arguments.prints_stats) {
      context.out << '\n';
      print_stats(*compilation, bytes.size(), context);
    }
  }
}

}  // namespace

void add_compile_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("compile", "compile a circuit file to a spike image");
  auto arguments = std::make_shared<CompileArguments>();
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOnly);
  command->add_option("-o,--output", arguments->output, "image to write [the circuit's name with .image, here]")
      ->type_name("FILE");
  command->add_flag("--stats", arguments->prints_stats, "time of each stage, what each pass did, bytes a synapse");
  command->footer(
      "The same file gives the same bytes.\n\n"
      "Examples:\n"
      "  tectum compile circuits/oculomotor.json -o out/oculomotor.image\n"
      "  tectum compile circuits/oculomotor.json -o out/no_opn.image --lesion OPN --stats\n");
  command->callback([arguments, &context] { compile(*arguments, context); });
}

}  // namespace tectum
