// Any text as a circuit file: compiled as far as it goes, its diagnostics rendered, its image loaded.
#include <cstdint>
#include <string>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"
#include "runtime/image/load_image.h"
#include "tests/fuzz/expect.h"

using namespace tectum;

namespace {

// Small enough that a run of the fuzzer is about the reader and not about millions of synapses.
constexpr std::uint64_t kMostNeurons = 300;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  CompileOptions options;
  options.last_stage = Stage::Validate;
  const SourceFile file{"fuzz.json", std::string(reinterpret_cast<const char*>(data), size)};
  Diagnostics first;
  const CompileResult validated = compile_circuit(file, options, first);
  TECTUM_EXPECT(validated.circuit.has_value() == !first.has_errors());
  static_cast<void>(render_text(first, validated.sources));
  static_cast<void>(render_json(first, validated.sources));
  if (!validated.circuit) {
    return 0;
  }
  std::uint64_t neurons = 0;
  for (const Population& population : validated.circuit->populations) {
    neurons += std::uint64_t{population.size} * population.instance_count;
  }
  if (neurons > kMostNeurons) {
    return 0;
  }
  options.last_stage = Stage::Lower;
  Diagnostics second;
  const CompileResult compiled = compile_circuit(file, options, second);
  TECTUM_EXPECT(compiled.image.has_value() == !second.has_errors());
  static_cast<void>(render_text(second, compiled.sources));
  if (compiled.image) {
    const LoadedImage loaded = load_image(write_image(*compiled.image));
    TECTUM_EXPECT(loaded.image.has_value());
  }
  return 0;
}
