// The accumulators of a few ticks, and who has input in them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "runtime/engine/aligned_vector.h"
#include "runtime/engine/slot_ranges.h"
#include "runtime/engine/update_group.h"

namespace tectum {

/// Accumulators for `tick_count` ticks of all slots. All are zero except between delivery and the
/// sweep that consumes them.
class InputRing {
 public:
  InputRing(const SpikeImage& image, const std::vector<std::unique_ptr<UpdateGroup>>& groups, std::uint32_t tick_count);

  void clear() noexcept;

  /// Adds a segment's weights to the accumulators of tick k. Real-time safe.
  void deliver(std::uint32_t k, std::uint32_t segment) noexcept;
  /// Starts to load what deliver() will need.
  void prefetch(std::uint32_t segment) const noexcept;
  /// Adds to one slot. Real-time safe.
  void add(std::uint32_t k, std::uint32_t slot, std::int32_t quanta) noexcept;

  [[nodiscard]] std::int32_t* inputs(std::uint32_t k, std::uint32_t group) noexcept {
    return inputs_.data() + k * stride_ + groups_[group].first_slot;
  }
  [[nodiscard]] std::int32_t value(std::uint32_t k, std::uint32_t slot) const noexcept {
    return inputs_[k * stride_ + slot];
  }
  /// The neurons of a group that have input, each once; empty for a group that wants no marks.
  [[nodiscard]] std::span<const std::uint32_t> touched(std::uint32_t k, std::uint32_t group) const noexcept {
    const Group& place = groups_[group];
    return {touched_.get() + k * touched_stride_ + place.touched_begin, touched_count_[k * groups_.size() + group]};
  }
  /// Forgets them. Who sweeps a group does this, and zeroes its accumulators.
  void clear_touched(std::uint32_t k, std::uint32_t group) noexcept;
  /// Groups with input for tick k, a bit each. Who sweeps a group clears its bit.
  [[nodiscard]] std::uint64_t& groups_with_input(std::uint32_t k, std::size_t word) noexcept {
    return has_input_[k * group_words_ + word];
  }
  [[nodiscard]] std::size_t group_words() const noexcept { return group_words_; }
  [[nodiscard]] const SlotRange& range_of(std::uint32_t slot) const noexcept { return ranges_.of(slot); }

 private:
  static constexpr std::uint32_t kMaxHotArrays = 4;
  struct Group {
    std::uint32_t first_slot;
    bool is_marked;
    std::size_t mark_begin;     // word in marks_ of one tick
    std::size_t touched_begin;  // in touched_ of one tick
    std::array<const std::uint32_t*, kMaxHotArrays> hot;
  };
  struct Run {
    const std::uint32_t* target;
    const std::uint32_t* end;
    const std::int32_t* weight;
    bool has_one_weight;
  };
  void deliver_run(std::uint32_t k, const SlotRange& range, const Run& run) noexcept;
  void deliver_marked_run(std::uint32_t k, const SlotRange& range, const Run& run) noexcept;

  const SpikeImage& image_;
  SlotRanges ranges_;
  std::vector<Group> groups_;
  std::size_t stride_;
  std::size_t mark_stride_ = 0;
  std::size_t touched_stride_ = 0;
  std::size_t group_words_;
  AlignedVector<std::int32_t> inputs_;        // [tick][slot]
  std::vector<std::uint64_t> marks_;          // [tick][word] bit a neuron: it is in touched_
  std::unique_ptr<std::uint32_t[]> touched_;  // [tick][neuron of a marked group], left unwritten until used
  std::vector<std::uint32_t> touched_count_;  // [tick][group]
  std::vector<std::uint64_t> has_input_;      // [tick][word of groups]
};

}  // namespace tectum
