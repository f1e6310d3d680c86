#include "tests/compiler/compiled_text.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "compiler/diagnostics/render.h"
#include "tests/support/test_network.h"

namespace tectum::test {

ImageContents compile_text(const std::string& text, const CompileOptions& options) {
  Diagnostics diagnostics;
  CompileResult result = compile_circuit({"circuit.json", text}, options, diagnostics);
  REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
  return std::move(*result.image);
}

SpikeImage image_of(const ImageContents& contents) {
  LoadedImage loaded = load_image(write_image(contents));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return std::move(*loaded.image);
}

NamedRaster named_raster(const ImageContents& contents, std::uint64_t ticks) {
  const SpikeImage image = image_of(contents);
  NamedRaster raster;
  for (const auto& [tick, neuron] : run_image(image, ticks)) {
    for (const PopulationRecord& population : image.populations) {
      if (neuron >= population.first_neuron && neuron < population.first_neuron + population.size) {
        std::string name(image.name(population.name));
        std::replace(name.begin(), name.end(), '.', '_');
        raster.emplace_back(tick, std::move(name), neuron - population.first_neuron);
      }
    }
  }
  std::sort(raster.begin(), raster.end());
  return raster;
}

std::string spike_times(std::uint32_t first_tick, std::uint32_t period_ticks, std::uint32_t ticks) {
  std::string text = "[";
  for (std::uint32_t tick = first_tick; tick < ticks; tick += period_ticks) {
    text += fmt::format("{}\"{}.{} ms\"", tick == first_tick ? "" : ", ", tick / 10, tick % 10);
  }
  return text + "]";
}

}  // namespace tectum::test
