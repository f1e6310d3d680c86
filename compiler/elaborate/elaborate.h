#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/elaborate/network.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// Told now and then how far the wiring is, 0 to 1, and how many synapses there are.
using ElaborateProgress = std::function<void(double share, std::size_t synapses)>;

/// Writes the circuit out. Can fail only where values depend on pairs of neurons (a weight that is not finite or
/// negative, a delay that is no whole number of ticks), where same-tick synapses form a cycle, and on resource limits.
[[nodiscard]] std::optional<Network> elaborate(const Circuit& circuit, Diagnostics& diagnostics,
                                               const ElaborateProgress& progress = {});

}  // namespace tectum
