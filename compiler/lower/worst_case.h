// What the engine may have to do in one tick, known before anything runs.
#pragma once

#include <cstdint>

#include "runtime/image/image_contents.h"

namespace tectum {

struct WorstCase {
  std::uint64_t synaptic_events = 0;  // in one tick
  std::uint32_t longest_row = 0;      // synapses of one neuron
  std::uint64_t synapse_bytes = 0;    // rows, segments, targets and weights
};

/// No tick of any run without injected spikes delivers more synaptic events: every neuron is taken to have fired as
/// often as its refractory period lets it, at the moments that make most of its synapses fall into the same tick.
[[nodiscard]] WorstCase worst_case(const ImageContents& image);

}  // namespace tectum
