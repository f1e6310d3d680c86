// What a segment of a row reaches, found once when the engine is built.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/engine/runner.h"
#include "runtime/engine/slot_ranges.h"
#include "runtime/image/load_image.h"

namespace tectum {

/// Most segments of a circuit reach one of a few sets of groups, so each knows the number of its set only.
class SegmentReach {
 public:
  /// Needs: `ranges` of the same image.
  SegmentReach(const SpikeImage& image, const SlotRanges& ranges, const UpdateGroups& groups);

  /// Groups that the segment reaches, a bit each.
  [[nodiscard]] std::span<const std::uint64_t> groups(std::uint32_t segment) const noexcept {
    return {&sets_[(of_[segment] >> kFlagBits) * words_], words_};
  }
  /// Its targets follow each other without a gap or a repetition.
  [[nodiscard]] bool is_dense(std::uint32_t segment) const noexcept { return (of_[segment] & kDense) != 0; }
  /// One of its groups wants to know which of its neurons have input.
  [[nodiscard]] bool wants_marks(std::uint32_t segment) const noexcept { return (of_[segment] & kMarks) != 0; }

 private:
  static constexpr std::uint32_t kDense = 1;
  static constexpr std::uint32_t kMarks = 2;
  static constexpr std::uint32_t kFlagBits = 2;

  std::size_t words_;
  std::vector<std::uint64_t> sets_;  // [set][word of groups]
  std::vector<std::uint32_t> of_;    // [segment]: number of its set, and the flags
};

}  // namespace tectum
