// Small circuits: the accumulators of a whole slice fit into the cache, so what is due in the slice
// is delivered first and then each group runs through its ticks.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "runtime/engine/event_wheel.h"
#include "runtime/engine/input_ring.h"
#include "runtime/engine/runner.h"

namespace tectum {

class RingRunner final : public Runner {
 public:
  /// Needs: `image` and `groups` outlive it.
  RingRunner(const SpikeImage& image, const UpdateGroups& groups);

  /// Ticks whose accumulators fit, at least 1.
  [[nodiscard]] static std::uint32_t fitting_ticks(const SpikeImage& image);

  void reset() noexcept override;
  std::uint32_t advance(std::uint64_t tick, std::uint64_t at_most, InjectedSpikes injected) noexcept override;
  [[nodiscard]] std::span<const NeuronId> spikes(std::uint32_t k) const noexcept override {
    return {spikes_.get() + std::size_t{k} * image_.header.neuron_count, spike_count_[k]};
  }
  [[nodiscard]] std::int32_t waiting_input(std::uint32_t slot) const noexcept override { return ring_.value(0, slot); }
  void add_input(std::uint32_t slot, std::int32_t quanta) noexcept override { ring_.add(0, slot, quanta); }
  void rouse(std::uint32_t group) noexcept override;
  [[nodiscard]] std::uint64_t synaptic_events() const noexcept override { return event_count_; }
  [[nodiscard]] std::uint64_t dropped_rows() const noexcept override { return wheel_.dropped(); }

 private:
  void deliver_due_rows(std::uint32_t k) noexcept;
  void advance_groups(std::uint32_t ticks) noexcept;
  void advance_group(std::uint32_t g, std::uint32_t ticks) noexcept;
  void advance_part(std::uint32_t g, std::uint32_t begin, std::uint32_t end, std::uint32_t k) noexcept;
  void send(std::uint32_t k, std::uint32_t neuron) noexcept;

  const SpikeImage& image_;
  const UpdateGroups& groups_;
  std::uint32_t slice_;  // most ticks of one advance()
  EventWheel wheel_;
  InputRing ring_;                         // [tick of the slice]
  std::vector<std::uint64_t> busy_;        // bit a group: to be advanced even without input
  std::vector<std::uint64_t> all_groups_;  // bit a group
  std::vector<std::uint64_t> idle_until_;  // of each group
  std::vector<bool> is_swept_in_blocks_;   // of each group
  bool is_in_neuron_order_ = true;         // the groups, as listed
  std::vector<std::uint32_t> fired_;
  std::unique_ptr<NeuronId[]> spikes_;  // [tick of the slice][neuron], left unwritten until used
  std::array<std::uint32_t, kMaxSliceTicks> spike_count_{};
  std::uint64_t tick_ = 0;  // of the slice's start
  InjectedSpikes injected_{};
  std::uint64_t event_count_ = 0;
};

}  // namespace tectum
