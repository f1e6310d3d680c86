// The accumulators of a few ticks, and who has input in them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "runtime/engine/aligned_vector.h"
#include "runtime/engine/delivery.h"
#include "runtime/engine/runner.h"
#include "runtime/engine/segment_reach.h"
#include "runtime/engine/slot_ranges.h"

namespace tectum {

/// Accumulators for `tick_count` ticks of all slots. All are zero except between delivery and the
/// sweep that consumes them.
class InputRing {
 public:
  InputRing(const SpikeImage& image, const UpdateGroups& groups, std::uint32_t tick_count);

  void clear() noexcept;

  /// Adds a segment's weights to the accumulators of tick k. Real-time safe.
  void deliver(std::uint32_t k, std::uint32_t segment) noexcept;
  /// Starts to load what deliver() will need.
  void prefetch(std::uint32_t segment) const noexcept;
  /// Adds to one slot. Real-time safe.
  void add(std::uint32_t k, std::uint32_t slot, std::int32_t quanta) noexcept;

  [[nodiscard]] std::int32_t* inputs(std::uint32_t k, std::uint32_t first_slot) noexcept {
    return inputs_.data() + k * stride_ + first_slot;
  }
  [[nodiscard]] std::int32_t value(std::uint32_t k, std::uint32_t slot) const noexcept {
    return inputs_[k * stride_ + slot];
  }
  /// The neurons of a group that have input; null for a group that wants no marks. Who sweeps clears them.
  [[nodiscard]] TouchedNeurons* touched(std::uint32_t k, std::uint32_t group) noexcept {
    const std::uint32_t index = touched_of_[group];
    return index == kNotMarked ? nullptr : &touched_[k * marked_count_ + index];
  }
  /// Groups with input for tick k, a bit each. Who sweeps a group clears its bit.
  [[nodiscard]] std::uint64_t& groups_with_input(std::uint32_t k, std::size_t word) noexcept {
    return has_input_[k * group_words_ + word];
  }

 private:
  static constexpr std::uint32_t kNotMarked = 0xFFFFFFFFU;

  void deliver_runs(std::uint32_t k, SynapseRun run) noexcept;
  void deliver_run(std::uint32_t k, const SlotRange& range, const SynapseRun& run) noexcept;

  const SpikeImage& image_;
  SlotRanges ranges_;
  SegmentReach reach_;
  std::size_t stride_;
  std::size_t group_words_;
  std::uint32_t marked_count_ = 0;          // groups that want marks
  AlignedVector<std::int32_t> inputs_;      // [tick][slot]
  std::vector<std::uint64_t> marks_;        // [tick][word]
  std::unique_ptr<std::uint32_t[]> lists_;  // [tick][neuron of a marked group], left unwritten until used
  std::vector<std::uint32_t> touched_of_;   // [group]
  std::vector<TouchedNeurons> touched_;     // [tick][marked group]
  std::vector<std::uint64_t> has_input_;    // [tick][word of groups]
};

}  // namespace tectum
