// The parts of verify_image that have their own files.
#pragma once

#include <string>

#include "runtime/image/load_image.h"

namespace tectum {

/// Rows, segments, targets, weights and projections. Needs: populations and groups checked.
[[nodiscard]] std::string verify_synapses(const SpikeImage& image);
/// What learns. Needs: populations, groups and synapses checked.
[[nodiscard]] std::string verify_plasticity(const SpikeImage& image);
/// Retinas, outputs, joints and programs. Needs: populations and groups checked.
[[nodiscard]] std::string verify_ports(const SpikeImage& image);

}  // namespace tectum
