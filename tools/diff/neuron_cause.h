// Why a neuron does one thing in one circuit and another in the other: each thing that differs about it is exchanged on
// its own, and what that alone would have done to its potential is the measure.
#pragma once

#include <string>
#include <vector>

#include "tools/diff/neuron_account.h"
#include "tools/diff/structure_diff.h"

namespace tectum {

struct NeuronPair {
  const CircuitView& a;
  const CircuitView& b;
  const StructureDiff& structure;
  const SpikeTicks& spikes_a;
  const SpikeTicks& spikes_b;
  std::uint32_t neuron_a = 0, neuron_b = 0;
  std::uint32_t tick = 0;
  bool fires_in_a = false;
  /// False: no spike differs, and the wider the potentials differ by it the better.
  bool is_about_spike = true;
};

struct NeuronCause {
  std::string why;                   // empty when nothing was found
  std::string from;                  // population of the second circuit whose spikes bring the difference
  std::vector<std::size_t> changes;  // of StructureDiff::changes
  std::string numbers;               // "-54.98 mV against -55.32 mV, threshold -55 mV"
};

[[nodiscard]] NeuronCause neuron_cause(const NeuronPair& pair);

/// Indices of changes of this element; an empty `property` or `where` stands for any.
[[nodiscard]] std::vector<std::size_t> changes_of(const StructureDiff& structure, Element element,
                                                  const std::string& name, const std::string& property = "",
                                                  const std::string& where = "");
/// "weight of ifn_llbn, IFN.left -> LLBN.left, is ... instead of ...: w_ifn_llbn is ... (file:line)"
[[nodiscard]] std::string change_sentence(const Change& change);
/// "LLBN.left[3]"
[[nodiscard]] std::string neuron_name(const CircuitView& view, std::uint32_t neuron);

}  // namespace tectum
