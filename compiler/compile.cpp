#include "compiler/compile.h"

#include <chrono>
#include <utility>

#include "compiler/compile_overrides.h"
#include "compiler/elaborate/elaborate.h"
#include "compiler/lower/lower.h"
#include "compiler/parse/parse_circuit.h"
#include "compiler/parse/parse_json.h"
#include "compiler/peak_memory.h"
#include "compiler/validate/validate.h"

namespace tectum {
namespace {

/// Runs one stage and notes its time, and its memory where that is asked for.
template <typename Run>
auto timed(Stage stage, const CompileOptions& options, CompileResult& result, const Run& run) {
  if (options.measures_memory) {
    reset_peak_memory();
  }
  const auto begin = std::chrono::steady_clock::now();
  auto made = run();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::uint64_t peak_bytes = options.measures_memory ? peak_memory_bytes() : 0;
  result.times.push_back({std::string(stage_name(stage)), seconds, peak_bytes});
  return made;
}

void run_stages(FileId file, const CompileOptions& options, Diagnostics& diagnostics, CompileResult& result) {
  const auto is_last = [&](Stage stage) { return options.last_stage == stage; };

  result.tree = timed(Stage::ParseJson, options, result, [&] { return parse_json(result.sources, file, diagnostics); });
  if (result.tree) {
    result.tree = compose(std::move(*result.tree), file, options.read, result.sources, diagnostics);
  }
  if (!result.tree || is_last(Stage::ParseJson)) {
    return;
  }
  result.decl = timed(Stage::ParseCircuit, options, result,
                      [&] { return parse_circuit(*result.tree, result.sources, diagnostics); });
  if (!result.decl || is_last(Stage::ParseCircuit)) {
    return;
  }
  const Overrides overrides = make_overrides(options, result.sources, diagnostics);
  result.circuit =
      timed(Stage::Validate, options, result, [&] { return validate(*result.decl, overrides, diagnostics); });
  if (!result.circuit || is_last(Stage::Validate)) {
    return;
  }
  result.network = timed(Stage::Elaborate, options, result,
                         [&] { return elaborate(*result.circuit, diagnostics, options.progress); });
  if (!result.network || is_last(Stage::Elaborate)) {
    return;
  }
  result.passes = timed(Stage::Optimise, options, result,
                        [&] { return optimise(*result.network, options.level, options.last_pass); });
  if (is_last(Stage::Optimise)) {
    return;
  }
  result.image = timed(Stage::Lower, options, result, [&] { return lower(*result.network); });
}

}  // namespace

CompileResult compile_circuit(SourceFile file, const CompileOptions& options, Diagnostics& diagnostics) {
  CompileResult result;
  const FileId id = result.sources.add(std::move(file));
  run_stages(id, options, diagnostics, result);
  diagnostics.sort();
  if (diagnostics.has_errors()) {
    result.image.reset();
  }
  return result;
}

}  // namespace tectum
