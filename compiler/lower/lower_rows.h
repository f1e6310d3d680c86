#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "compiler/elaborate/network.h"
#include "runtime/image/image_contents.h"

namespace tectum {

inline constexpr std::uint32_t kNoSlot = std::numeric_limits<std::uint32_t>::max();

/// Slot of (receptor r, neuron i) of each population: slot_of[population][r * size + i]; kNoSlot for silenced neurons.
struct SlotLayout {
  std::vector<std::vector<std::uint32_t>> slot_of;
};

/// Fills row_begin, segments, targets, weights and max_delay_ticks. Synapses of one row with the same delay and slot
/// keep their order. Where the network says so, a run of one weight stores it once, but for weights that learn. Where
/// something learns, returns which target each synapse has become.
std::vector<std::uint32_t> lower_rows(const Network& network, const SlotLayout& layout, ImageContents& image);

}  // namespace tectum
