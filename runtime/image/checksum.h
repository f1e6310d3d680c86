// The image's checksum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tectum {

/// A 64-bit checksum that runs at the speed of memory. Any change that is confined to one aligned
/// 8-byte word, so any single flipped bit, changes the result with certainty; any other change
/// goes unnoticed with probability about 2^-64. Not meant against forgery.
[[nodiscard]] std::uint64_t checksum64(std::span<const std::byte> bytes, std::uint64_t seed = 0);

/// Of a whole image file: every byte, with the header's checksum field read as zero.
[[nodiscard]] std::uint64_t image_checksum(std::span<const std::byte> file);

}  // namespace tectum
