#pragma once

#include <optional>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/circuit_decl.h"
#include "compiler/parse/json_tree.h"

namespace tectum {

/// Checks the shape of a circuit: known keys, right JSON types, nothing missing. Reports every problem it
/// finds and poisons what it concerns; returns nothing only when the text is no object. Modules come out expanded.
/// `sources` says in which directory each file lies.
[[nodiscard]] std::optional<CircuitDecl> parse_circuit(const JsonTree& tree, const Sources& sources,
                                                       Diagnostics& diagnostics);

/// The one language version there is.
inline constexpr int kLanguageVersion = 1;

}  // namespace tectum
