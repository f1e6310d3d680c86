// Which pixels of one image row are lit.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/image/spike_image.h"

namespace tectum {

/// Compares `pixel_count` interleaved BGR pixels with the threshold. `lit[3 * i]` becomes 1 where pixel i has
/// channel > lit_above and 0 elsewhere; the bytes between are 0. Returns whether any pixel is lit.
/// `first_of_pixel[3 * i]` must be 1 and its other bytes 0; both arrays hold 3 * pixel_count bytes.
/// Real-time safe.
[[nodiscard]] bool mark_lit_pixels(LitChannel channel, std::uint32_t lit_above, const std::uint8_t* bgr,
                                   std::size_t pixel_count, const std::uint8_t* first_of_pixel,
                                   std::uint8_t* lit) noexcept;

}  // namespace tectum
