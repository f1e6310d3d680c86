#include "runtime/engine/segment_reach.h"

#include <algorithm>
#include <map>

namespace tectum {
namespace {

bool follow_each_other(std::span<const std::uint32_t> targets) {
  if (targets.back() - targets.front() + 1 != targets.size()) {
    return false;
  }
  return std::adjacent_find(targets.begin(), targets.end(),
                            [](std::uint32_t a, std::uint32_t b) { return a + 1 != b; }) == targets.end();
}

}  // namespace

SegmentReach::SegmentReach(const SpikeImage& image, const SlotRanges& ranges, const UpdateGroups& groups)
    : words_((groups.size() + kWordBits - 1) / kWordBits) {
  std::map<std::vector<std::uint64_t>, std::uint32_t> numbers;
  std::vector<std::uint64_t> set(words_);
  for (std::size_t s = 0; s + 1 < image.segments.size(); ++s) {
    const std::span<const std::uint32_t> targets = image.targets.subspan(
        image.segments[s].target_begin, image.segments[s + 1].target_begin - image.segments[s].target_begin);
    std::fill(set.begin(), set.end(), std::uint64_t{0});
    std::uint32_t flags = !targets.empty() && follow_each_other(targets) ? kDense : 0;
    for (auto target = targets.begin(); target != targets.end();) {
      const SlotRange& range = ranges.of(*target);
      set[range.group / kWordBits] |= std::uint64_t{1} << (range.group % kWordBits);
      flags |= groups[range.group]->wants_marks() ? kMarks : 0;
      target = std::lower_bound(target, targets.end(), range.end);
    }
    const auto [found, is_new] = numbers.try_emplace(set, static_cast<std::uint32_t>(numbers.size()));
    if (is_new) {
      sets_.insert(sets_.end(), set.begin(), set.end());
    }
    of_.push_back((found->second << kFlagBits) | flags);
  }
}

}  // namespace tectum
