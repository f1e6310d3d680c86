#include "tools/bench/row_builder.h"

#include <algorithm>

namespace tectum::bench {

void append_row(std::vector<RowSynapse>& synapses, std::uint32_t delay_ticks, ImageContents& image) {
  image.row_begin.push_back(static_cast<std::uint32_t>(image.segments.size()));
  if (synapses.empty()) {
    return;
  }
  std::sort(synapses.begin(), synapses.end(), [](const RowSynapse& a, const RowSynapse& b) { return a.slot < b.slot; });
  const std::int32_t first = synapses[0].quanta;
  const bool has_one_weight =
      std::all_of(synapses.begin(), synapses.end(), [&](const RowSynapse& s) { return s.quanta == first; });
  image.segments.push_back({delay_ticks, static_cast<std::uint32_t>(image.targets.size()),
                            static_cast<std::uint32_t>(image.weights.size()),
                            has_one_weight ? std::uint32_t{kSegmentOneWeight} : 0U});
  for (const RowSynapse& synapse : synapses) {
    image.targets.push_back(synapse.slot);
    if (!has_one_weight) {
      image.weights.push_back(synapse.quanta);
    }
  }
  if (has_one_weight) {
    image.weights.push_back(first);
  }
  image.max_delay_ticks = std::max(image.max_delay_ticks, delay_ticks);
}

void finish_rows(ImageContents& image) {
  while (image.row_begin.size() <= image.neuron_count) {
    image.row_begin.push_back(static_cast<std::uint32_t>(image.segments.size()));
  }
  image.segments.push_back(
      {0, static_cast<std::uint32_t>(image.targets.size()), static_cast<std::uint32_t>(image.weights.size()), 0});
}

}  // namespace tectum::bench
