#include "tools/tectum/load_circuit.h"

#include <fmt/format.h>

#include <cstddef>
#include <fstream>
#include <vector>

#include "compiler/diagnostics/render.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

std::string count_text(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace

bool is_image_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 64> head{};
  file.read(head.data(), head.size());
  return looks_like_image(std::as_bytes(std::span(head).first(static_cast<std::size_t>(file.gcount()))));
}

void add_circuit_arguments(CLI::App& command, CircuitArguments& arguments, CircuitKinds kinds) {
  const char* what = kinds == CircuitKinds::FileOrImage ? "circuit file (JSON), or an image that was compiled before"
                                                        : "circuit file (JSON)";
  command.add_option("circuit", arguments.path, what)->required()->type_name("CIRCUIT");
  command
      .add_option("--lesion", arguments.lesions,
                  "take out a population (OPN), one side (EBN.left), a projection (sc_llbn) or a pathway (SC*->LLBN), "
                  "or a share of it (OPN:0.5); repeatable")
      ->type_name("NAME")
      ->expected(1)
      ->take_all();
  command.add_option("-p,--parameter", arguments.parameters, "set a parameter: -p g_sc='0.5 nA'; repeatable")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
  command.add_option("-O", arguments.optimisation, "optimisation level; never changes what a circuit does")
      ->check(CLI::IsMember({0, 1, 2}))
      ->capture_default_str();
  command.add_option("--circuit-seed", arguments.circuit_seed, "instead of the file's `seed`")->type_name("N");
  command.add_option("--format", arguments.format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
}

CompileOptions compile_options(const CircuitArguments& arguments) {
  CompileOptions options;
  options.level = static_cast<OptimisationLevel>(arguments.optimisation);
  options.seed = arguments.circuit_seed;
  options.lesions = arguments.lesions;
  options.parameters = arguments.parameters;
  return options;
}

std::optional<Compilation> compile_file(const CircuitArguments& arguments, const CompileOptions& options,
                                        CommandContext& context) {
  ReadSource source = read_source(arguments.path);
  if (!source.ok) {
    context.err << fmt::format("tectum: {}\n", source.error);
    context.exit_status = kExitTrouble;
    return std::nullopt;
  }
  Compilation compilation;
  CompileOptions shown_options = options;
  Progress progress(context.err, "compiling " + arguments.path);
  shown_options.progress = [&](double share, std::size_t synapses) {
    progress.update(share, fmt::format("{} synapses", synapses));
  };
  compilation.result = compile_circuit(std::move(source.file), shown_options, compilation.diagnostics);
  if (compilation.diagnostics.has_errors()) {
    context.exit_status = kExitFailed;
  }
  return compilation;
}

void print_diagnostics(const Compilation& compilation, CommandContext& context) {
  const Diagnostics& diagnostics = compilation.diagnostics;
  if (diagnostics.all().empty()) {
    return;
  }
  context.err << render_text(diagnostics, compilation.result.sources);
  const std::string errors = count_text(diagnostics.error_count(), "error");
  const std::string warnings = count_text(diagnostics.warning_count(), "warning");
  if (diagnostics.error_count() == 0) {
    context.err << warnings << '\n';
  } else {
    context.err << (diagnostics.warning_count() == 0 ? errors : errors + ", " + warnings) << '\n';
  }
}

std::optional<SpikeImage> load_circuit(const CircuitArguments& arguments, CommandContext& context,
                                       WarningPolicy policy) {
  LoadedImage loaded;
  if (is_image_file(arguments.path)) {
    if (!arguments.lesions.empty() || !arguments.parameters.empty() || arguments.circuit_seed) {
      context.err << "tectum: --lesion, -p and --circuit-seed change a circuit file; an image is already compiled\n";
      context.exit_status = kExitUsage;
      return std::nullopt;
    }
    loaded = load_image_file(arguments.path);
  } else {
    const std::optional<Compilation> compilation = compile_file(arguments, compile_options(arguments), context);
    if (!compilation) {
      return std::nullopt;
    }
    if (compilation->diagnostics.has_errors() || policy == WarningPolicy::Print) {
      if (arguments.format == "json") {
        context.out << render_json(compilation->diagnostics, compilation->result.sources) << '\n';
      } else {
        print_diagnostics(*compilation, context);
      }
    }
    if (!compilation->result.image) {
      return std::nullopt;
    }
    loaded = load_image(write_image(*compilation->result.image));
  }
  if (!loaded.image) {
    context.err << fmt::format("tectum: {}\n", loaded.error);
    context.exit_status = kExitTrouble;
  }
  return std::move(loaded.image);
}

}  // namespace tectum
