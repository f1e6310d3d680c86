#include "tests/circuits/compiled_circuit.h"

#include <doctest/doctest.h>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"

namespace tectum {

std::string oculomotor_text() {
  ReadSource source = read_source(TECTUM_SOURCE_DIR "/circuits/oculomotor.json");
  REQUIRE_MESSAGE(source.ok, source.error);
  return source.file.bytes;
}

SpikeImage compiled_circuit(const std::string& text, const std::vector<std::string>& lesions) {
  Diagnostics diagnostics;
  CompileOptions options;
  options.lesions = lesions;
  const CompileResult result = compile_circuit({"oculomotor.json", text}, options, diagnostics);
  REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
  LoadedImage loaded = load_image(write_image(*result.image));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return *loaded.image;
}

}  // namespace tectum
