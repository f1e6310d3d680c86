// tectum compile: a circuit file to a spike image.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>

#include "compiler/diagnostics/render.h"
#include "compiler/lower/worst_case.h"
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

constexpr double kMegabyte = 1e6;

/// "812 of 900 runs of synapses store one weight"
std::string shared_weights_text(const ImageContents& image) {
  const std::size_t runs = image.segments.size() - 1;  // the last is a sentinel
  const auto shared = std::count_if(image.segments.begin(), image.segments.end() - 1, [](const SegmentRecord& segment) {
    return (segment.flags & kSegmentOneWeight) != 0;
  });
  return fmt::format("{} of {} rows store one weight, {} weights for {} synapses", shared, runs, image.weights.size(),
                     image.targets.size());
}

void print_stats(const Compilation& compilation, std::size_t image_bytes, CommandContext& context) {
  const CompileResult& result = compilation.result;
  context.out << fmt::format("{:<28} {:>10} {:>12}\n", "stage", "ms", "peak MB");
  for (const StageTime& time : result.times) {
    context.out << fmt::format("{:<28} {:>10.2f} {:>12.1f}\n", time.name, time.seconds * 1e3,
                               static_cast<double>(time.peak_bytes) / kMegabyte);
  }
  if (!result.passes.empty()) {
    context.out << fmt::format("\n{:<28} {:>10} {:>12} {:>12}\n", "pass", "ms", "synapses in", "out");
  }
  for (const PassStats& pass : result.passes) {
    const std::string note = pass.name == "share_constant_weights" ? shared_weights_text(*result.image) : pass.note;
    context.out << fmt::format("{:<28} {:>10.2f} {:>12} {:>12}{}\n", pass.name, pass.seconds * 1e3,
                               pass.synapses_before, pass.synapses_after, note.empty() ? "" : "  " + note);
  }
  const WorstCase worst = worst_case(*result.image);
  context.out << fmt::format("\nin one tick at most {} synaptic events, from one neuron at most {}\n",
                             worst.synaptic_events, worst.longest_row);
  const auto synapses = result.image->targets.size();
  context.out << fmt::format("image {} bytes", image_bytes);
  if (synapses > 0) {
    context.out << fmt::format(", {:.2f} bytes a synapse",
                               static_cast<double>(worst.synapse_bytes) / static_cast<double>(synapses));
  }
  context.out << '\n';
}

void compile(const CompileArguments& arguments, CommandContext& context) {
  CompileOptions options = compile_options(arguments.circuit);
  options.measures_memory = arguments.prints_stats;
  const std::optional<Compilation> compilation = compile_file(arguments.circuit, options, context);
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
  command->add_flag("--stats", arguments->prints_stats,
                    "time and peak memory of each stage, what each pass did, the worst tick, bytes a synapse");
  command->footer(
      "The same file gives the same bytes.\n\n"
      "Examples:\n"
      "  tectum compile circuits/oculomotor.json -o out/oculomotor.image\n"
      "  tectum compile circuits/oculomotor.json -o out/no_opn.image --lesion OPN --stats\n");
  command->callback([arguments, &context] { compile(*arguments, context); });
}

}  // namespace tectum
