#include "runtime/engine/slot_ranges.h"

#include <algorithm>

namespace tectum {

SlotRanges::SlotRanges(const SpikeImage& image) {
  for (std::uint32_t g = 0; g < image.groups.size(); ++g) {
    const GroupRecord& group = image.groups[g];
    for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
      const std::uint32_t begin = group.first_slot + r * group.size;
      ranges_.push_back({begin, begin + group.size, g, r});
    }
  }
  std::sort(ranges_.begin(), ranges_.end(), [](const SlotRange& a, const SlotRange& b) { return a.begin < b.begin; });
  std::uint32_t range = 0;
  for (std::uint32_t slot = 0; slot < image.header.slot_count; slot += kStride) {
    while (slot >= ranges_[range].end) {
      ++range;
    }
    first_in_stride_.push_back(range);
  }
}

}  // namespace tectum
