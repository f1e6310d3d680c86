// Runs a spike image: one tick at a time, or several at once.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "runtime/image/load_image.h"

namespace tectum {

/// How a sweep is done. Never changes what is computed: every setting gives the same raster.
enum class SweepStrategy { Automatic, Dense, Sparse };
enum class SimdLevel { Automatic, Portable, Avx2, Avx512 };

struct EngineOptions {
  SweepStrategy sweep = SweepStrategy::Automatic;
  SimdLevel simd = SimdLevel::Automatic;
  unsigned threads = 1;  // 0: as many as make it faster, measured when the engine is built; 1 for small circuits
};

/// Counters of things that should not happen, and of work done. Read after the run.
struct EngineCounters {
  std::uint64_t ticks = 0;
  std::uint64_t spikes = 0;
  std::uint64_t synaptic_events = 0;
  std::uint64_t saturated_inputs = 0;  // injections clipped to the accumulator's range
  std::uint64_t dropped_rows = 0;      // spikes in flight that found no room: the raster is wrong
};

class SpikeEngine {
 public:
  /// Not real-time safe: allocates everything that step() will ever need.
  /// `image` is copied by value; its storage is shared.
  explicit SpikeEngine(const SpikeImage& image, const EngineOptions& options = {});
  ~SpikeEngine();
  SpikeEngine(SpikeEngine&&) noexcept;
  SpikeEngine& operator=(SpikeEngine&&) noexcept;

  /// Back to the initial state, tick 0. Real-time safe.
  void reset() noexcept;

  /// Advances by one tick. Real-time safe: no allocation, lock, log, exception or system call.
  void step() noexcept;

  /// Advances by at least one and at most `at_most` ticks and returns how many: as many as can be
  /// done at once, which is faster than one by one and gives the same raster. What was injected
  /// counts in the first of them. Needs: at_most > 0. Real-time safe.
  std::uint32_t advance(std::uint64_t at_most) noexcept;

  /// Ticks done so far: the spikes() after n steps belong to tick n - 1.
  [[nodiscard]] std::uint64_t tick() const noexcept;

  /// Neurons that fired in the last tick, ascending.
  [[nodiscard]] std::span<const NeuronId> spikes() const noexcept;
  /// Neurons that fired in tick k, counted from 0, of the last advance(), ascending.
  [[nodiscard]] std::span<const NeuronId> spikes(std::uint32_t k) const noexcept;

  /// Holds a FieldSource neuron on or off from the next tick until told otherwise. Real-time safe.
  void set_field_active(NeuronId neuron, bool is_active) noexcept;

  /// Makes a neuron of any model fire in the next tick, in addition to what it does itself
  /// (its state is not reset). Real-time safe.
  void inject_spike(NeuronId neuron) noexcept;

  /// Adds to a slot's accumulator for the next tick, in the receptor's physical unit
  /// (the projection weight's unit). Clips and counts. Real-time safe.
  void inject_input(SlotId slot, double weight) noexcept;

  /// Probe: state variable `column` of a neuron in its physical unit (column 0 is v in mV for the
  /// membrane models), brought up to the current tick. Real-time safe.
  [[nodiscard]] double probe(NeuronId neuron, std::uint32_t column) const noexcept;

  /// Weights in quanta, in the order of SpikeImage::weights, to be changed between ticks: what is due from the next
  /// tick on is delivered with them. reset() brings the image's own back. Empty unless the image learns.
  [[nodiscard]] std::span<std::int32_t> plastic_weights() noexcept;

  [[nodiscard]] const EngineCounters& counters() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
