// Large circuits, and several threads. The neurons are divided into partitions, one a thread, and
// each large group of a partition into blocks whose state fits into the first-level cache. A slice
// of ticks goes block by block: deliver what is due to the block, sweep it, tick after tick. No spike
// of the slice arrives within it, so the blocks and the partitions need nothing from each other
// until its end.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "runtime/engine/aligned_vector.h"
#include "runtime/engine/block_partition.h"
#include "runtime/engine/runner.h"
#include "runtime/engine/slot_ranges.h"
#include "runtime/engine/thread_team.h"

namespace tectum {

class BlockRunner final : public Runner {
 public:
  /// Needs: no same-tick synapses; `image` and `groups` outlive it.
  BlockRunner(const SpikeImage& image, const UpdateGroups& groups, unsigned threads);

  void reset() noexcept override;
  std::uint32_t advance(std::uint64_t tick, std::uint64_t at_most, InjectedSpikes injected) noexcept override;
  [[nodiscard]] std::span<const NeuronId> spikes(std::uint32_t k) const noexcept override {
    return {spikes_.get() + std::size_t{k} * image_.header.neuron_count, spike_count_[k]};
  }
  [[nodiscard]] std::int32_t waiting_input(std::uint32_t slot) const noexcept override { return inputs_[slot]; }
  void add_input(std::uint32_t slot, std::int32_t quanta) noexcept override;
  void rouse(std::uint32_t group) noexcept override;
  [[nodiscard]] std::uint64_t synaptic_events() const noexcept override;
  [[nodiscard]] std::uint64_t dropped_rows() const noexcept override;

 private:
  void work(unsigned member) noexcept;

  const SpikeImage& image_;
  std::uint32_t slice_;
  SlotRanges ranges_;
  AlignedVector<std::int32_t> inputs_;  // [slot], of one tick
  std::vector<std::unique_ptr<BlockPartition>> partitions_;
  std::unique_ptr<ThreadTeam> team_;  // null for one thread
  SliceOfTicks now_{};
  std::unique_ptr<NeuronId[]> spikes_;  // [tick of the slice][neuron], left unwritten until used
  std::array<std::uint32_t, kMaxSliceTicks> spike_count_{};
};

}  // namespace tectum
