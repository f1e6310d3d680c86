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

// Included and extended files: "self" is the input again, anything else a small module; neither is read from disk.
constexpr const char* kModule = R"({ "tectum": 1, "name": "module", "tick": "0.1 ms",
  "neurons": { "cell": { "model": "lif_exp" } }, "populations": { "A": { "neuron": "cell", "size": 2 } } })";

SourceReader reader_of(const std::string& input) {
  return [&input](const std::string& path) {
    const bool is_self = path.find("self") != std::string::npos;
    return ReadSource{true, {path, is_self ? input : kModule}, {}};
  };
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  CompileOptions options;
  options.last_stage = Stage::Validate;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const SourceFile file{"fuzz.json", text};
  options.read = reader_of(text);
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
