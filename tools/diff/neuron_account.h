// Why a neuron's potential is what it is: the share of each pathway, from the spikes alone.
//
// A leaky integrate-and-fire potential is a sum: what its own last reset (or its start) has left, and what each
// arriving spike has added since. So the shares of the pathways follow from the spikes that arrived, in closed form and
// in double precision; the engine's float32 differs from them in the sixth digit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/diff/circuit_view.h"

namespace tectum {

/// Ticks at which each neuron fired, ascending.
using SpikeTicks = std::vector<std::vector<std::uint32_t>>;
[[nodiscard]] SpikeTicks spike_ticks(const std::vector<RecordedSpike>& spikes, std::uint32_t neuron_count);

struct Arrival {
  std::uint32_t tick = 0;
  double weight = 0;
  std::uint32_t pre = 0;  // neuron of the circuit
};

/// What one pathway brings to one neuron.
struct PathwayInput {
  std::uint32_t pathway = 0;   // of CircuitView::pathways
  std::uint32_t receptor = 0;  // of NeuronSetup::receptors
  std::vector<Arrival> arrivals;
};

/// Everything that decides what a neuron does, taken out of its circuit, so that one part of it can be exchanged.
struct NeuronSetup {
  std::string model;
  double tick_ms = 0;
  bool is_silenced = false;
  std::vector<ParameterView> parameters;  // one value each
  std::vector<ReceptorView> receptors;
  std::vector<PathwayInput> inputs;
  std::vector<std::uint32_t> own_spikes;

  /// 0 for one that the model does not have.
  [[nodiscard]] double value(const std::string& parameter) const;
};

/// Arrivals up to and including `last_tick`.
[[nodiscard]] NeuronSetup neuron_setup(const CircuitView& view, const SpikeTicks& spikes, std::uint32_t neuron,
                                       std::uint32_t last_tick);

struct InputShare {
  double input = 0;      // now, in the unit of the weights
  double potential = 0;  // its part of the potential, mV; of the sum, for a threshold unit
};

struct NeuronAccount {
  /// The potential is known: integrate-and-fire models and threshold units. Others have inputs only.
  bool has_potential = false;
  std::string unit;      // of the potential
  double potential = 0;  // as compared with the threshold at the tick
  double threshold = 0;
  double own = 0;  // what is not of any pathway: rest, bias, the last reset
  bool is_refractory = false;
  std::vector<InputShare> shares;  // one a NeuronSetup::inputs
  [[nodiscard]] bool fires() const { return has_potential && !is_refractory && potential >= threshold; }
};

/// At `tick`, with the resets of own_spikes before it.
[[nodiscard]] NeuronAccount account_of(const NeuronSetup& setup, std::uint32_t tick);

/// Mean over ticks [from, to) of what one pathway brings, in the unit of the weights. Needs: from < to.
[[nodiscard]] double mean_input(const NeuronSetup& setup, const PathwayInput& input, std::uint32_t from,
                                std::uint32_t to);

}  // namespace tectum
