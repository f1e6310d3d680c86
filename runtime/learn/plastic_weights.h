#pragma once

#include <cstdint>
#include <vector>

#include "runtime/image/load_image.h"

namespace tectum {

/// Where each plastic synapse's weight lies in SpikeImage::weights. Not real-time safe.
[[nodiscard]] std::vector<std::uint32_t> plastic_weight_places(const SpikeImage& image);

}  // namespace tectum
