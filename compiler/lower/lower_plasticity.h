#pragma once

#include <cstdint>
#include <vector>

#include "compiler/elaborate/network.h"
#include "runtime/image/image_contents.h"

namespace tectum {

/// Fills plasticity, plastic_synapses and decays. `target_of` has an element a synapse, `projection_of` one a pathway.
/// Nothing where nothing learns.
void lower_plasticity(const Network& network, const std::vector<std::uint32_t>& target_of,
                      const std::vector<std::uint32_t>& projection_of, ImageContents& image);

/// exp(-tick 2^k / tau) for k = 0 .. kDecayPowers - 1.
void append_decays(double tick_ms, double tau_ms, std::vector<double>& decays);

}  // namespace tectum
