#pragma once

#include <string>

#include "compiler/compile.h"

namespace tectum {

/// What has no source: parameters, neuron types, populations and projections, each with its place, and what share of
/// the synapses the uncited projections make. Needs: a result with its network.
[[nodiscard]] std::string provenance_text(const CompileResult& result);

/// The same as one JSON object.
[[nodiscard]] std::string provenance_json(const CompileResult& result);

}  // namespace tectum
