#include "tests/exchange/exchanged_circuit.h"

#include <doctest/doctest.h>
#include <stdlib.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "tectum-exchange-XXXXXX").string();
  folder_ = mkdtemp(pattern.data());
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

CommandResult tectum(const std::vector<std::string>& args) {
  std::ostringstream out;
  std::ostringstream err;
  CommandResult result;
  result.exit_status = tectum_main(args, out, err);
  result.out = out.str();
  result.err = err.str();
  return result;
}

CommandResult tectum_succeeds(const std::vector<std::string>& args) {
  CommandResult result = tectum(args);
  REQUIRE_MESSAGE(result.exit_status == 0, result.err);
  return result;
}

std::string every_model_path() { return TECTUM_SOURCE_DIR "/tests/exchange/every_model.json"; }
std::string oculomotor_path() { return TECTUM_SOURCE_DIR "/circuits/oculomotor.json"; }

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE_MESSAGE(file.good(), path);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_text(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

SpikeImage compiled_file(const std::string& path) {
  ReadSource source = read_source(path);
  REQUIRE_MESSAGE(source.ok, source.error);
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit(std::move(source.file), {}, diagnostics);
  REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
  LoadedImage loaded = load_image(write_image(*result.image));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return *loaded.image;
}

}  // namespace tectum
