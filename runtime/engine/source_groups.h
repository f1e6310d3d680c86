// Neurons that fire by themselves: receptive fields, Poisson trains, given spike times.
#pragma once

#include <span>
#include <vector>

#include "runtime/engine/update_group.h"

namespace tectum {

/// Fires in the first tick after its field became active and every period while it stays active.
class FieldGroup final : public UpdateGroup {
 public:
  FieldGroup(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept override;
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;
  void set_active(std::uint32_t neuron, bool is_active) noexcept override;

 private:
  std::vector<std::uint32_t> period_ticks_;
  std::vector<std::uint32_t> wait_ticks_;  // until the next spike, while active
  std::vector<std::uint8_t> is_active_;
};

/// One Bernoulli draw a neuron and tick: word (tick mod 4) of Philox block (tick / 4), keyed by the
/// circuit's seed, the population's name and the neuron's index in the population.
class PoissonGroup final : public UpdateGroup {
 public:
  PoissonGroup(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept override {}
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;

 private:
  std::uint64_t key_;
  std::uint64_t name_hash_;
  std::uint32_t first_index_;               // of the group in its population
  std::vector<std::uint64_t> fires_below_;  // of a 32-bit word
};

class SpikeListGroup final : public UpdateGroup {
 public:
  SpikeListGroup(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept override { next_ = 0; }
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;

 private:
  std::span<const std::uint32_t> spikes_;  // (tick, neuron) pairs, ascending
  std::size_t next_ = 0;
};

}  // namespace tectum
