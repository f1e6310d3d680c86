#pragma once

#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/elaborate/network.h"

namespace tectum {

/// Multiplies the weights of each scaling's projections by the factor that gives their matrix the leading eigenvalue
/// (the largest by its size) that the circuit asks for. `weights` are physical and signed, one a synapse.
/// Reports a matrix without such a factor.
void scale_weights(const Circuit& circuit, const Network& network, std::vector<double>& weights,
                   Diagnostics& diagnostics);

}  // namespace tectum
