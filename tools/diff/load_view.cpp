#include "tools/diff/load_view.h"

#include <array>
#include <fstream>

#include "compiler/diagnostics/render.h"

namespace tectum {

LoadedView compile_view(SourceFile file) {
  LoadedView loaded;
  const std::string name = file.name;
  CompileOptions options;
  options.level = OptimisationLevel::O0;  // merging would drop the projection of a synapse
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit(std::move(file), options, diagnostics);
  if (!result.image || !result.network) {
    loaded.error = render_text(diagnostics, result.sources);
    loaded.is_wrong_circuit = true;
    return loaded;
  }
  LoadedImage image = load_image(write_image(*result.image));
  if (!image.image) {
    loaded.error = "tectum: " + name + ": " + image.error + "\n";
    return loaded;
  }
  loaded.view = view_of_compilation(name, *image.image, result);
  return loaded;
}

LoadedView load_view(const std::string& path) {
  std::array<char, 64> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  LoadedView loaded;
  if (looks_like_image(std::as_bytes(std::span(head).first(static_cast<std::size_t>(file.gcount()))))) {
    LoadedImage image = load_image_file(path);
    if (image.image) {
      loaded.view = view_of_image(path, *image.image);
    } else {
      loaded.error = "tectum: " + path + ": " + image.error + "\n";
    }
    return loaded;
  }
  ReadSource source = read_source(path);
  if (!source.ok) {
    loaded.error = "tectum: " + source.error + "\n";
    return loaded;
  }
  return compile_view(std::move(source.file));
}

}  // namespace tectum
