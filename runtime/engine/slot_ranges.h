// Which receptor of which group a slot belongs to.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/image/load_image.h"

namespace tectum {

/// One receptor's slots of one group.
struct SlotRange {
  std::uint32_t begin;
  std::uint32_t end;
  std::uint32_t group;
  std::uint32_t receptor;
};

/// The ranges tile the slots, ascending.
class SlotRanges {
 public:
  explicit SlotRanges(const SpikeImage& image);

  [[nodiscard]] const SlotRange& of(std::uint32_t slot) const noexcept {
    std::uint32_t r = first_in_stride_[slot / kStride];
    while (slot >= ranges_[r].end) {
      ++r;
    }
    return ranges_[r];
  }

 private:
  static constexpr std::uint32_t kStride = 32;  // slots that share an entry into the ranges

  std::vector<SlotRange> ranges_;
  std::vector<std::uint32_t> first_in_stride_;
};

}  // namespace tectum
