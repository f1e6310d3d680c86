// Any text as a circuit file: compiled as far as it goes, its diagnostics rendered, its image loaded.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
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

// Tables and edge lists are read from disk: these lie beside the circuit.
constexpr const char* kCells = "id;class;side\nk1;KC;L\n\"m;1\";MN;L\nk2;KC;R\nm2;motor;L\nlost;PN;L\n";
constexpr const char* kEdges =
    "a|b|n|kind\nk1|m;1|3|chemical\nk2|m;1|1|chemical\nk2|k1|2|electrical\nlost|m;1|4|chemical\n"
    "m;1|k2|2|chemical\nm2|k1|1|chemical\nk1|k1|5|chemical\n";
constexpr const char* kNumberedEdges = "pre,post,w\n0,1,0.5\n1,0,2\n2,2,-1\n";

class FilesBeside {
 public:
  FilesBeside() {
    std::string name = (std::filesystem::temp_directory_path() / "fuzz_circuit.XXXXXX").string();
    TECTUM_EXPECT(mkdtemp(name.data()) != nullptr);
    folder_ = name;
    std::ofstream(folder_ / "cells.csv") << kCells;
    std::ofstream(folder_ / "edges.csv") << kEdges;
    std::ofstream(folder_ / "wires.csv") << kNumberedEdges;
  }
  ~FilesBeside() { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string circuit() const { return (folder_ / "fuzz.json").string(); }

 private:
  std::filesystem::path folder_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FilesBeside kFiles;
  CompileOptions options;
  options.last_stage = Stage::Validate;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const SourceFile file{kFiles.circuit(), text};
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
