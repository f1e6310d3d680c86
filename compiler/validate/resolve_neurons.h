#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/validate/validation.h"

namespace tectum {

/// Follows `extends` and finds the model; reports cycles and unknown names, each once.
/// The result is parallel to decl.neurons; null where a type is unusable.
[[nodiscard]] std::vector<std::optional<ResolvedNeuron>> resolve_neurons(Validation& v);

/// The receptors of a population: those declared, the shorthands tau_syn_ex and tau_syn_in (which it takes out of
/// `parameters`), or the model's usual pair.
[[nodiscard]] std::vector<Receptor> resolve_receptors(Validation& v, const ResolvedNeuron& neuron,
                                                      std::vector<KeyedValue>& parameters);

}  // namespace tectum
