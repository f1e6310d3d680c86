#pragma once

#include <vector>

#include "compiler/elaborate/network.h"

namespace tectum {

/// Largest relative error that rounding to quanta caused, projection by projection. Weights below a thousandth of
/// the projection's strongest count as that much.
struct RoundingReport {
  std::vector<double> largest_relative_error;  // index: ProjectionId
};

/// Picks each receptor's quantum, a power of two, so that the sum over all synapses onto any slot stays below 2^30,
/// and turns `weights` (physical, signed, one a synapse) into network.synapses.quanta. A weight that learns counts as
/// the highest that it can come to.
/// Needs: every other column of the synapses. The sides of a population share their quanta.
RoundingReport quantise(const Circuit& circuit, const std::vector<double>& weights, Network& network);

}  // namespace tectum
