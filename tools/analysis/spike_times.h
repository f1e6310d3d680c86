// When spikes happened, in seconds, without a copy of them all.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/record/recording.h"

namespace tectum {

/// Turns ticks into seconds. Ticks are anchored at each frame's (tick, time_ns), so that a frame period that is no
/// whole number of ticks does not drift. Calls with ascending ticks are fast.
class SpikeClock {
 public:
  explicit SpikeClock(const Recording& recording);
  [[nodiscard]] double time_s(std::uint64_t tick);

 private:
  const Recording& recording_;
  double tick_s_;
  std::size_t frame_ = 0;
};

/// The spikes in [begin_s, end_s).
[[nodiscard]] std::span<const RecordedSpike> spikes_between(const Recording&, double begin_s, double end_s);

/// Population of every neuron, by neuron number; kNoPopulation for neurons that none holds.
inline constexpr std::uint32_t kNoPopulation = ~std::uint32_t{0};
[[nodiscard]] std::vector<std::uint32_t> population_of_neurons(const Recording&);

/// The time of every spike, in recording order.
[[nodiscard]] std::vector<double> spike_times_s(const Recording&);

}  // namespace tectum
