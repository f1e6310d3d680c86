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
  std::vector<std::uint64_t> next_tick_;  // of its next spike, while active
  std::vector<std::uint8_t> is_active_;
};

/// Each neuron fires in each tick with probability p = rate h, independently. Instead of a draw a
/// tick, the number of silent ticks before the next spike is drawn at once: with a uniform u in
/// [0, 1), it is the largest n with (1 - p)^n >= 1 - u, the inverse of the geometric distribution.
/// n is found among 0 .. 1023; 1023 stands for "no spike so far", after which the next draw goes on.
/// Draw d of a neuron is half d mod 2 of Philox block d / 2, keyed by the circuit's seed, the
/// population's name and the neuron's index in the population.
class PoissonGroup final : public UpdateGroup {
 public:
  PoissonGroup(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept override;
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;

 private:
  static constexpr std::uint32_t kWaitBits = 10;
  static constexpr std::uint32_t kMaxWait = (1U << kWaitBits) - 1;  // ticks
  static constexpr std::uint32_t kBuckets = 2 << kWaitBits;         // more than the longest wait plus one
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  static constexpr std::uint32_t kTabledRates = 8;  // of a group: each table takes 9 KiB
  static constexpr std::uint32_t kGuideSize = 512;
  struct Chance {
    double rate_hz;
    double silent[kWaitBits];  // (1 - p)^(2^b)
    /// The same search, tabled: (1 - p)^n for n = 0 .. kMaxWait, and where to begin in it for a 1 - u between j /
    /// kGuideSize and the next. Empty where a group has many rates, or a rate so low that the powers do not fall.
    std::vector<double> silent_for;
    std::vector<std::uint16_t> guide;

    void make_tables();
    [[nodiscard]] double silent_for_ticks(std::uint32_t wait) const noexcept;
    /// The largest wait whose chance is at least `left`.
    [[nodiscard]] std::uint32_t wait_of(double left) const noexcept;
  };

  [[nodiscard]] std::uint32_t draw_wait(std::uint32_t neuron) noexcept;
  /// Puts the neuron into the bucket in which its next spike, or its next draw, is due.
  void schedule(std::uint32_t neuron, std::uint64_t tick) noexcept;

  std::uint64_t key_;
  std::uint64_t name_hash_;
  std::uint32_t first_index_;               // of the group in its population
  std::vector<Chance> chances_;             // one for each rate
  std::vector<std::uint32_t> chance_of_;    // [neuron]
  std::vector<std::uint64_t> draw_count_;   // [neuron]
  std::vector<std::uint64_t> second_half_;  // [neuron] of the block that its last even draw began
  std::vector<std::uint8_t> fires_;         // [neuron] what is due is a spike, not a draw
  std::vector<std::uint32_t> next_;         // [neuron] in the same bucket
  std::vector<std::uint32_t> buckets_;      // [tick mod kBuckets] first neuron due
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
