// What the simulated head draws at random: each draw is a pure function of seed, purpose and index, so that none
// depends on how many others were made.
#pragma once

#include <cstdint>

#include "runtime/image/philox.h"

namespace tectum::head {

/// What a draw is for; keeps the streams of one seed apart.
enum class Stream : std::uint32_t {
  ServoDeadTime = 1,
  RandomTarget = 2,
  SensorNoise = 3,
  NoiseTile = 4,
  WallTexture = 5,
  DroppedFrames = 6
};

[[nodiscard]] inline PhiloxWords draw(std::uint64_t seed, Stream stream, std::uint64_t index,
                                      std::uint32_t part = 0) noexcept {
  return philox4x32(seed, {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32U), part,
                           static_cast<std::uint32_t>(stream)});
}

/// In the open interval (0, 1).
[[nodiscard]] constexpr double unit_interval(std::uint32_t word) { return (word + 0.5) * 0x1p-32; }

}  // namespace tectum::head
