// Reads a group's parameters out of the image.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/image/models.h"

namespace tectum {

class GroupParameters {
 public:
  GroupParameters(const SpikeImage& image, const GroupRecord& group) : image_(image), group_(group) {}

  [[nodiscard]] bool varies(std::uint32_t p) const { return ((mask() >> p) & 1U) != 0; }

  [[nodiscard]] double value(std::uint32_t p, std::uint32_t neuron = 0) const {
    if (!varies(p)) {
      return image_.parameters[group_.parameter_begin + p];
    }
    const auto column = static_cast<std::size_t>(std::popcount(mask() & ((1U << p) - 1U)));
    return image_.columns[group_.column_begin + column * group_.size + neuron];
  }

  /// A duration in ms as whole ticks; verify_image has checked that it is whole.
  [[nodiscard]] std::uint32_t ticks(std::uint32_t p) const {
    return static_cast<std::uint32_t>(std::llround(value(p) / tick_ms()));
  }
  [[nodiscard]] double tick_ms() const { return static_cast<double>(image_.header.tick_ns) * 1e-6; }

  [[nodiscard]] const ReceptorRecord& receptor(std::uint32_t r) const {
    return image_.receptors[group_.first_receptor + r];
  }
  /// The physical weight of one quantum.
  [[nodiscard]] double quantum(std::uint32_t r) const { return std::ldexp(1.0, receptor(r).quantum_log2); }
  /// exp(-h / tau_r) of an exponential receptor.
  [[nodiscard]] double receptor_decay(std::uint32_t r) const {
    const std::uint32_t from_end = group_.receptor_count - r;
    return image_.parameters[group_.parameter_begin + group_.parameter_count - from_end];
  }

 private:
  [[nodiscard]] std::uint32_t mask() const { return group_.flags >> kGroupColumnShift; }

  const SpikeImage& image_;
  const GroupRecord& group_;
};

/// Adds two accumulators. Wraps instead of overflowing: an image whose weights break the 2^30 rule
/// gives nonsense, never undefined behaviour.
[[nodiscard]] inline std::int32_t add_quanta(std::int32_t a, std::int32_t b) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

}  // namespace tectum
