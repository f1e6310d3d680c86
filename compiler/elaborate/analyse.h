#pragma once

#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/elaborate/network.h"

namespace tectum {

/// Warns of what is legal and rarely meant: populations that nothing drives, that reach no output, or that both
/// excite and inhibit, and projections without a source. Looks at the circuit as declared, before lesions.
void analyse(const Circuit& circuit, const Network& network, const std::vector<double>& weights,
             Diagnostics& diagnostics);

}  // namespace tectum
