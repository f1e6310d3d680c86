#include "tests/circuits/compiled_circuit.h"

#include <doctest/doctest.h>

#include <utility>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"

namespace tectum {
namespace {

SpikeImage image_of(SourceFile file, const CompileOptions& options) {
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit(std::move(file), options, diagnostics);
  REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
  LoadedImage loaded = load_image(write_image(*result.image));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return *loaded.image;
}

}  // namespace

std::string oculomotor_text() {
  ReadSource source = read_source(TECTUM_SOURCE_DIR "/circuits/oculomotor.json");
  REQUIRE_MESSAGE(source.ok, source.error);
  return source.file.bytes;
}

SpikeImage compiled_circuit(const std::string& text, const std::vector<std::string>& lesions) {
  CompileOptions options;
  options.lesions = lesions;
  return image_of({"oculomotor.json", text}, options);
}

SpikeImage shipped_circuit(const std::string& file, const std::vector<std::string>& parameters,
                           const std::vector<std::string>& lesions) {
  ReadSource source = read_source(TECTUM_SOURCE_DIR "/circuits/" + file);
  REQUIRE_MESSAGE(source.ok, source.error);
  CompileOptions options;
  options.parameters = parameters;
  options.lesions = lesions;
  return image_of(std::move(source.file), options);
}

}  // namespace tectum
