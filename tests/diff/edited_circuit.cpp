#include "tests/diff/edited_circuit.h"

#include <doctest/doctest.h>

namespace tectum {

namespace {

std::string text_of(const std::string& path) {
  ReadSource source = read_source(path);
  REQUIRE_MESSAGE(source.ok, source.error);
  return source.file.bytes;
}

}  // namespace

std::string oculomotor_text() { return text_of(TECTUM_SOURCE_DIR "/circuits/oculomotor.json"); }
std::string small_eye_text() { return text_of(TECTUM_SOURCE_DIR "/tests/diff/small_eye.json"); }

std::string edited(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE_MESSAGE(at != std::string::npos, what);
  REQUIRE_MESSAGE(text.find(what, at + 1) == std::string::npos, what);
  return text.replace(at, what.size(), with);
}

CircuitView compiled_view(const std::string& text) {
  LoadedView loaded = compile_view({"circuit.json", text});
  REQUIRE_MESSAGE(loaded.error.empty(), loaded.error);
  return std::move(loaded.view);
}

}  // namespace tectum
