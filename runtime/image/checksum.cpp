#include "runtime/image/checksum.h"

#include <array>
#include <bit>
#include <cstring>

#include "runtime/image/spike_image.h"

namespace tectum {
namespace {

// Two odd 64-bit constants with an irregular bit pattern: the golden ratio and the square root of two.
constexpr std::uint64_t kOddA = 0x9E3779B97F4A7C15ULL;
constexpr std::uint64_t kOddB = 0x6A09E667F3BCC909ULL;
constexpr std::size_t kLanes = 8;
constexpr std::size_t kStripeBytes = kLanes * sizeof(std::uint64_t);

std::uint64_t load_word(const std::byte* at) {
  std::uint64_t word = 0;
  std::memcpy(&word, at, sizeof(word));
  return word;
}

// Each step is a bijection of the state for a given word and of the word for a given state, so two
// inputs that differ in one word can never meet again.
std::uint64_t mix(std::uint64_t state, std::uint64_t word) { return std::rotl((state ^ word) * kOddA, 29); }

std::uint64_t finish(std::uint64_t state) {
  state ^= state >> 32U;
  state *= kOddB;
  return state ^ (state >> 29U);
}

}  // namespace

std::uint64_t checksum64(std::span<const std::byte> bytes, std::uint64_t seed) {
  std::array<std::uint64_t, kLanes> lanes{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    lanes[lane] = seed + kOddB * (lane + 1);
  }
  const std::byte* at = bytes.data();
  const std::size_t stripes = bytes.size() / kStripeBytes;
  for (std::size_t stripe = 0; stripe < stripes; ++stripe, at += kStripeBytes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      lanes[lane] = mix(lanes[lane], load_word(at + lane * sizeof(std::uint64_t)));
    }
  }
  std::size_t rest = bytes.size() - stripes * kStripeBytes;
  for (std::size_t lane = 0; rest > 0; ++lane) {
    std::uint64_t word = 0;
    const std::size_t taken = rest < sizeof(word) ? rest : sizeof(word);
    std::memcpy(&word, at, taken);
    lanes[lane] = mix(lanes[lane], word);
    at += taken;
    rest -= taken;
  }
  std::uint64_t state = mix(kOddB, bytes.size());
  for (const std::uint64_t lane : lanes) {
    state = mix(state, lane);
  }
  return finish(state);
}

std::uint64_t image_checksum(std::span<const std::byte> file) {
  if (file.size() < sizeof(FileHeader)) {
    return 0;
  }
  std::array<std::byte, sizeof(FileHeader)> header{};
  std::memcpy(header.data(), file.data(), header.size());
  std::memset(header.data() + offsetof(FileHeader, checksum), 0, sizeof(std::uint64_t));
  return checksum64(file.subspan(sizeof(FileHeader)), checksum64(header));
}

}  // namespace tectum
