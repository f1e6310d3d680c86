// Where a loop passes on the spikes of each tick.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/image/spike_image.h"

namespace tectum {

class SpikeSink {
 public:
  SpikeSink() = default;
  SpikeSink(const SpikeSink&) = delete;
  SpikeSink& operator=(const SpikeSink&) = delete;
  virtual ~SpikeSink() = default;
  /// The neurons that fired in `tick`, ascending. Called once a tick, also when none fired. Called within the loop:
  /// an implementation for real-time runs must be real-time safe.
  virtual void take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept = 0;
};

}  // namespace tectum
