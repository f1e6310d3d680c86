// The hand-written floor: what a short loop over the same arrays costs, written for these networks and
// nothing else. The engine is measured against it.
//
// Dense: every tick adds the due rows to one accumulator a slot and sweeps all neurons; the sweep is one
// loop over plain arrays, vectorised for the very machine (CMakeLists.txt). Silent: as dense, but a neuron
// that cannot reach threshold without input is left alone until its next input and then advanced in closed form.
// Both read the Poisson trains from a list instead of drawing them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/image/load_image.h"

namespace tectum {

/// Spikes of the source populations, tick by tick.
struct Stimulus {
  std::vector<std::uint32_t> begin;    // [ticks + 1]
  std::vector<std::uint32_t> neurons;  // ascending within a tick

  [[nodiscard]] std::span<const std::uint32_t> of(std::uint64_t tick) const {
    return std::span(neurons).subspan(begin[tick], begin[tick + 1] - begin[tick]);
  }
};

/// Runs the engine once and keeps what its poisson, spike_list and field populations fire.
[[nodiscard]] Stimulus record_stimulus(const SpikeImage& image, std::uint64_t ticks);
/// The same of every neuron.
[[nodiscard]] Stimulus record_raster(const SpikeImage& image, std::uint64_t ticks);

class Floor {
 public:
  /// Nothing for a network that the floor was not written for: it takes lif_exp with one or two receptors and
  /// shared parameters but V_init, sources, and one delay a row.
  static std::optional<Floor> make(const SpikeImage& image);

  void reset();
  /// One tick. Returns who fired, in no order; source spikes are not among them.
  std::span<const std::uint32_t> step_dense(std::span<const std::uint32_t> stimulus);
  std::span<const std::uint32_t> step_silent(std::span<const std::uint32_t> stimulus);

 private:
  struct Row {
    std::uint32_t begin, end;  // targets
    std::uint32_t delay_ticks;
    float one_weight;  // NaN: one a target
  };
  struct Group {
    std::uint32_t first_neuron, size, first_slot;
    float rest_mv, threshold_mv, reset_mv, decay, gain_ex, decay_ex, gain_in, decay_in, peak_ex;
    std::int32_t refractory_ticks;
    bool has_inhibition;
    std::vector<float> initial_mv, v_mv, ex, in;  // v relative to rest
    std::vector<std::int32_t> refractory, fires;
    // Silent only.
    std::vector<std::uint32_t> awake, touched;
    std::vector<std::uint8_t> is_awake, is_touched;
    std::vector<std::uint32_t> valid_after;
    std::vector<float> leap_decay, leap_gain, leap_decay_ex;  // [ticks]
  };

  void send(std::uint32_t neuron);
  void deliver(bool lists_targets);
  void sweep(Group& group, float* ex, float* in);
  void advance_awake(Group& group, float* ex);
  void fire(Group& group, std::uint32_t i);
  void wake_touched(Group& group, float* ex);
  [[nodiscard]] Group& group_of_slot(std::uint32_t slot);

  const SpikeImage* image_ = nullptr;
  std::vector<Row> rows_;       // [neuron]
  std::vector<float> weights_;  // of each target, physical
  std::vector<Group> groups_;
  std::vector<float> inputs_;                    // [slot]
  std::vector<std::vector<std::uint32_t>> due_;  // [tick mod size] neurons whose rows arrive
  std::vector<std::uint32_t> fired_;
  std::uint64_t tick_ = 0;
};

}  // namespace tectum
