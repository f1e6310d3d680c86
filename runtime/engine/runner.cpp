#include "runtime/engine/runner.h"

#include <algorithm>

namespace tectum {

std::uint32_t shortest_delay_ticks(const SpikeImage& image) {
  std::uint32_t shortest = kMaxSliceTicks;
  for (std::size_t k = 0; k + 1 < image.segments.size(); ++k) {
    const std::uint32_t delay = image.segments[k].delay_ticks;
    shortest = delay == 0 ? shortest : std::min(shortest, delay);
  }
  return shortest;
}

bool has_same_tick_synapses(const SpikeImage& image) {
  return std::any_of(image.segments.begin(), image.segments.end() - 1,
                     [](const SegmentRecord& segment) { return segment.delay_ticks == 0; });
}

std::uint64_t rows_in_flight(const SpikeImage& image) {
  std::uint64_t rows = 0;
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    const std::uint32_t end = image.row_begin[neuron + 1];
    rows += end == image.row_begin[neuron] ? 0 : std::uint64_t{image.segments[end - 1].delay_ticks} + 1;
  }
  return rows;
}

void add_injected(InjectedSpikes injected, std::uint32_t first_neuron, GroupTick& now) noexcept {
  const std::uint32_t own_count = now.fired_count;
  for (std::uint32_t i = now.begin; i < now.end; ++i) {
    const std::uint32_t neuron = first_neuron + i;
    const bool is_injected = ((injected.neurons[neuron / kWordBits] >> (neuron % kWordBits)) & 1U) != 0;
    if (is_injected && !std::binary_search(now.fired, now.fired + own_count, i)) {
      now.fire(i);
    }
  }
  std::sort(now.fired, now.fired + now.fired_count);
}

}  // namespace tectum
