#pragma once

#include <vector>

#include "compiler/validate/validation.h"

namespace tectum {

/// Where a population's values come from, in the order in which they hold.
struct ParameterSources {
  const std::vector<KeyedValue>& parameters;  // of the neuron type and the population
  const std::vector<ExceptionDecl>& exceptions;
  const std::vector<KeyedValue>& position;
};

/// Evaluates the parameters of every side of a population, neuron by neuron where they vary, and its positions.
/// Needs: the population's model, size, axes and instances, and its retinas' positions. False when it is not known
/// where the neurons lie, because of a mistake that has been reported.
[[nodiscard]] bool apply_parameters(Validation& v, Population& population, const ModelInfo& model,
                                    const ParameterSources& sources, const NameDecl& owner);

/// Checks names, dimensions and ranges of the values alone: a type may leave open what a population gives.
void check_parameters(Validation& v, Population& population, const ModelInfo& model,
                      const std::vector<KeyedValue>& parameters);

}  // namespace tectum
