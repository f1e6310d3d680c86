// How the ticks of a slice are carried out: by RingRunner for small circuits, by BlockRunner for
// large ones and several threads. Both give the same raster.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "runtime/engine/spike_engine.h"
#include "runtime/engine/update_group.h"

namespace tectum {

using UpdateGroups = std::vector<std::unique_ptr<UpdateGroup>>;

/// Most ticks of one slice.
inline constexpr std::uint32_t kMaxSliceTicks = 16;
/// Neurons that go through a slice together: their state fits into the second-level cache, and the
/// rows that are cut at their bounds stay long enough to be worth it.
inline constexpr std::uint32_t kBlockNeurons = 4096;
inline constexpr std::uint32_t kWordBits = 64;

/// Neurons that fire in the first tick of a slice whatever they do themselves.
struct InjectedSpikes {
  const std::uint64_t* neurons;  // bit a neuron
  bool any;
};

class Runner {
 public:
  Runner() = default;
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;
  virtual ~Runner() = default;

  virtual void reset() noexcept = 0;
  /// Advances from tick `tick` by 1 to `at_most` ticks and returns how many. Real-time safe.
  virtual std::uint32_t advance(std::uint64_t tick, std::uint64_t at_most, InjectedSpikes injected) noexcept = 0;
  /// Of tick k of the last slice, ascending.
  [[nodiscard]] virtual std::span<const NeuronId> spikes(std::uint32_t k) const noexcept = 0;
  /// Quanta that wait in a slot's accumulator for the next tick.
  [[nodiscard]] virtual std::int32_t waiting_input(std::uint32_t slot) const noexcept = 0;
  virtual void add_input(std::uint32_t slot, std::int32_t quanta) noexcept = 0;
  /// The group may have something to do again, without input.
  virtual void rouse(std::uint32_t group) noexcept = 0;

  [[nodiscard]] virtual std::uint64_t synaptic_events() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t dropped_rows() const noexcept = 0;
};

/// The longest slice: no spike of it arrives within it, but by same-tick synapses.
[[nodiscard]] std::uint32_t shortest_delay_ticks(const SpikeImage& image);
[[nodiscard]] bool has_same_tick_synapses(const SpikeImage& image);
/// Bound on the spikes that wait for one of their delays at a time.
[[nodiscard]] std::uint64_t rows_in_flight(const SpikeImage& image);
/// Merges the injected neurons of a part into those that fired by themselves; keeps them ascending.
void add_injected(InjectedSpikes injected, std::uint32_t first_neuron, GroupTick& now) noexcept;

}  // namespace tectum
