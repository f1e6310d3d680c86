#include "tests/eval/evaluated_circuit.h"

#include <doctest/doctest.h>

#include "compiler/diagnostics/render.h"

namespace tectum {

std::string shipped_path(const std::string& name) { return TECTUM_SOURCE_DIR "/circuits/" + name; }

SpikeImage compiled_image(const std::string& name, const CompileOptions& options) {
  ReadSource source = read_source(shipped_path(name));
  REQUIRE_MESSAGE(source.ok, source.error);
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit(std::move(source.file), options, diagnostics);
  REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
  LoadedImage loaded = load_image(write_image(*result.image));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return std::move(*loaded.image);
}

const SpikeImage& oculomotor_image() {
  static const SpikeImage image = compiled_image("oculomotor.json", {});
  return image;
}

Protocol shipped_protocol(const std::string& name) {
  const ReadProtocol read = read_protocol_file(shipped_path("protocols/" + name + ".json"));
  REQUIRE_MESSAGE(read.protocol.has_value(), (read.error + read.problems));
  return *read.protocol;
}

}  // namespace tectum
