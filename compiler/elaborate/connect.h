#pragma once

#include <functional>
#include <string>

#include "compiler/elaborate/pair_block.h"
#include "compiler/expression/random_stream.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// Pairs of two population sides that the projection's rule and `where` choose, in blocks, in a fixed order
/// (by presynaptic index, then postsynaptic; by postsynaptic first for fixed_in_degree).
/// `take` returns false to stop. Returns false when it was stopped, or when an edge list cannot be read: then `error`
/// says why.
bool connect(const Projection& projection, const Circuit& circuit, const Instance& pre, const Instance& post,
             const RandomStream& random, PairVariables& variables, const std::function<bool(PairBlock&)>& take,
             std::string& error);

}  // namespace tectum
