// A wire that misbehaves on request, the same way for the same seed.
#pragma once

#include <cstdint>
#include <random>

#include "runtime/ports/frame.h"

namespace tectum {

/// Shares of bytes, or of answers, that something happens to; each byte has at most one of the four.
struct WireFaults {
  double flipped = 0;   // one random bit: the error that an 8-bit sum misses most easily
  double replaced = 0;  // by any other byte
  double lost = 0;
  double inserted = 0;  // a random byte before it
  double missing_answers = 0;
  double late_answers = 0;
  TimeNs lateness_ns = 5'000'000;

  /// `share` of all bytes: half of them flipped, a fifth each replaced and lost, a tenth with a stray byte before.
  [[nodiscard]] static WireFaults bytes(double share) noexcept {
    WireFaults faults;
    faults.flipped = 0.5 * share;
    faults.replaced = 0.2 * share;
    faults.lost = 0.2 * share;
    faults.inserted = 0.1 * share;
    return faults;
  }
};

class WireNoise {
 public:
  explicit WireNoise(std::uint64_t seed) noexcept : random_(seed) {}

  WireFaults faults;

  /// Calls `deliver` with what arrives of `byte`: nothing, one byte or two.
  template <typename Deliver>
  void pass(std::uint8_t byte, Deliver&& deliver) noexcept {
    const double total = faults.flipped + faults.replaced + faults.lost + faults.inserted;
    if (total <= 0) {
      deliver(byte);
      return;
    }
    double draw = uniform();
    if (draw >= total) {
      deliver(byte);
      return;
    }
    ++damaged_bytes_;
    if (draw < faults.flipped) {
      deliver(static_cast<std::uint8_t>(byte ^ (1U << (random_() & 7U))));
      return;
    }
    draw -= faults.flipped;
    if (draw < faults.replaced) {
      deliver(static_cast<std::uint8_t>(byte + 1 + random_() % 255));
      return;
    }
    draw -= faults.replaced;
    if (draw < faults.lost) {
      return;
    }
    deliver(static_cast<std::uint8_t>(random_()));
    deliver(byte);
  }
  /// True with this probability.
  [[nodiscard]] bool happens(double probability) noexcept { return probability > 0 && uniform() < probability; }
  /// In [0, 1).
  [[nodiscard]] double uniform() noexcept { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  [[nodiscard]] std::uint64_t damaged_bytes() const noexcept { return damaged_bytes_; }

 private:
  std::mt19937_64 random_;
  std::uint64_t damaged_bytes_ = 0;
};

}  // namespace tectum
