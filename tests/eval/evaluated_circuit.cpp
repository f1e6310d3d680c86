#include "tests/eval/evaluated_circuit.h"

#include <doctest/doctest.h>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"

namespace tectum {

const SpikeImage& oculomotor_image() {
  static const SpikeImage image = [] {
    ReadSource source = read_source(TECTUM_SOURCE_DIR "/circuits/oculomotor.json");
    REQUIRE_MESSAGE(source.ok, source.error);
    Diagnostics diagnostics;
    const CompileResult result = compile_circuit(std::move(source.file), {}, diagnostics);
    REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
    LoadedImage loaded = load_image(write_image(*result.image));
    REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
    return std::move(*loaded.image);
  }();
  return image;
}

Protocol shipped_protocol(const std::string& name) {
  const ReadProtocol read = read_protocol_file(TECTUM_SOURCE_DIR "/circuits/protocols/" + name + ".json");
  REQUIRE_MESSAGE(read.protocol.has_value(), (read.error + read.problems));
  return *read.protocol;
}

}  // namespace tectum
