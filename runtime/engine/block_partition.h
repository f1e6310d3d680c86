// One thread's share of a large circuit: its neurons, the rows on their way to them, its spikes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "runtime/engine/delivery.h"
#include "runtime/engine/event_wheel.h"
#include "runtime/engine/runner.h"
#include "runtime/engine/slot_ranges.h"

namespace tectum {

/// Neurons [begin, end) of a group.
struct GroupPart {
  std::uint32_t group;
  std::uint32_t begin;
  std::uint32_t end;
};

/// What all partitions share.
struct BlockNetwork {
  const SpikeImage& image;
  const UpdateGroups& groups;
  const SlotRanges& ranges;
  std::int32_t* inputs;  // [slot], of one tick
};

struct SliceOfTicks {
  std::uint64_t tick;
  std::uint32_t count;
  InjectedSpikes injected;
};

class BlockPartition {
 public:
  /// `is_one_of_several`: where each row's synapses onto these neurons begin and end is found once and kept, 16 bytes a
  /// row and receptor, instead of being searched for whenever the row is due.
  BlockPartition(const BlockNetwork& network, std::vector<GroupPart> parts, bool is_one_of_several);

  void reset() noexcept;
  /// Carries out the slice and keeps its spikes. Writes nothing that another partition reads or writes.
  void run(const SliceOfTicks& slice) noexcept;
  /// Sends the spikes of a partition on to the rows' later ticks.
  void receive(const SliceOfTicks& slice, const BlockPartition& from) noexcept;

  /// Neurons of this partition that fired in tick k of the last slice, part by part.
  [[nodiscard]] std::span<const std::uint32_t> spikes(std::uint32_t k) const noexcept {
    return {spikes_.get() + std::size_t{k} * neuron_count_, spike_count_[k]};
  }
  /// Input that came from outside. Does nothing for a slot of another partition.
  void add_input(std::uint32_t slot, std::int32_t quanta) noexcept;
  void rouse(std::uint32_t group) noexcept;
  [[nodiscard]] std::uint64_t event_count() const noexcept { return event_count_; }
  [[nodiscard]] std::uint64_t dropped_rows() const noexcept { return wheel_.dropped(); }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  static constexpr std::uint32_t kRunCapacity = 1U << 16U;

  struct Part {
    GroupPart range;
    bool is_swept_in_blocks;
    TouchedNeurons touched;  // of a group that wants marks
    std::uint64_t idle_until = 0;
    std::array<std::uint32_t, kMaxSliceTicks> first_run;  // of each tick
    std::array<bool, kMaxSliceTicks> has_input;
  };
  // A run that waits for its blocks to come.
  struct WaitingRun {
    SynapseRun run;
    std::uint32_t first_slot;  // of its receptor
    std::uint32_t next;        // of the same part and tick
  };

  // Synapses [begin, end) of the image, onto one receptor of a part.
  struct OwnRun {
    std::uint32_t begin;
    std::uint32_t end;
    std::uint32_t part;
    std::uint32_t first_slot;
  };

  void list_own_runs();
  [[nodiscard]] SynapseRun run_of(const SegmentRecord& segment, std::uint32_t begin, std::uint32_t end) const noexcept;
  void prefetch(const SegmentRecord& segment, std::uint32_t begin, std::uint32_t end) const noexcept;
  template <typename TakeRun>
  void search_row(std::uint32_t segment, TakeRun take_run) const noexcept;
  [[nodiscard]] std::uint32_t collect(std::uint64_t tick, std::uint32_t first, std::uint32_t count) noexcept;
  template <typename TakeRun>
  void take_due_rows(std::uint64_t tick, TakeRun take_run) noexcept;
  template <typename TakeRun>
  void split_row(std::uint32_t segment, TakeRun take_run) noexcept;
  void deliver(Part& part, std::uint32_t k, std::uint32_t first_slot, const SynapseRun& run) noexcept;
  void deliver_block(const Part& part, std::uint32_t k, std::uint32_t block_end) noexcept;
  void run_part(Part& part, const SliceOfTicks& slice, std::uint32_t first, std::uint32_t end) noexcept;
  void advance(Part& part, const SliceOfTicks& slice, std::uint32_t k, std::uint32_t begin, std::uint32_t end) noexcept;
  void prefetch_place(std::uint32_t segment) const noexcept;
  void prefetch(std::uint32_t segment) const noexcept;

  BlockNetwork network_;
  EventWheel wheel_;
  std::vector<Part> parts_;                   // in update order
  std::vector<std::uint32_t> part_of_;        // [group] index or kNone
  std::vector<std::uint32_t> own_run_begin_;  // [segment + 1], empty for a partition that has all neurons
  std::vector<OwnRun> own_runs_;
  std::size_t receptor_count_ = 0;  // of all parts
  std::size_t neuron_count_ = 0;
  std::vector<std::uint64_t> marks_;
  std::unique_ptr<std::uint32_t[]> lists_;
  std::unique_ptr<WaitingRun[]> runs_;
  std::uint32_t run_count_ = 0;
  std::vector<std::uint32_t> fired_;
  std::unique_ptr<std::uint32_t[]> spikes_;  // [tick of the slice][neuron], left unwritten until used
  std::array<std::uint32_t, kMaxSliceTicks> spike_count_{};
  std::uint64_t event_count_ = 0;
};

}  // namespace tectum
