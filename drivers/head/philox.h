// Philox4x32-10: random numbers as a pure function of key and counter, so that no draw depends on how many
// others were made. Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3",
// doi:10.1145/2063384.2063405.
#pragma once

#include <array>
#include <cstdint>

namespace tectum::head {

using PhiloxWords = std::array<std::uint32_t, 4>;

[[nodiscard]] constexpr PhiloxWords philox(PhiloxWords counter, std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t kMultiply0 = 0xD2511F53U;
  constexpr std::uint64_t kMultiply1 = 0xCD9E8D57U;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9U;
  constexpr std::uint32_t kWeyl1 = 0xBB67AE85U;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = kMultiply0 * counter[0];
    const std::uint64_t product1 = kMultiply1 * counter[2];
    counter = {static_cast<std::uint32_t>(product1 >> 32U) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product1),
               static_cast<std::uint32_t>(product0 >> 32U) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product0)};
    key = {key[0] + kWeyl0, key[1] + kWeyl1};
  }
  return counter;
}

/// What a draw is for; keeps the streams of one seed apart.
enum class Stream : std::uint32_t {
  ServoDeadTime = 1,
  RandomTarget = 2,
  SensorNoise = 3,
  NoiseTile = 4,
  WallTexture = 5
};

[[nodiscard]] constexpr PhiloxWords draw(std::uint64_t seed, Stream stream, std::uint64_t index,
                                         std::uint32_t part = 0) {
  return philox({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32U), part,
                 static_cast<std::uint32_t>(stream)},
                {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)});
}

/// In the open interval (0, 1).
[[nodiscard]] constexpr double unit_interval(std::uint32_t word) { return (word + 0.5) * 0x1p-32; }

}  // namespace tectum::head
