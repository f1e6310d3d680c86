#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/circuit_decl.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// What the command line sets over the file; each has its own span, in a source of its own.
struct Overrides {
  std::optional<std::uint64_t> seed;
  std::vector<ParameterDecl> parameters;
  std::vector<LesionDecl> lesions;
};

/// Resolves names and converts quantities to fixed units. Reports every problem it finds, and is silent about what
/// follows from one that was reported before. Returns a circuit only if there were none, here and in the stages
/// before, so no later stage checks names, units or ranges again.
[[nodiscard]] std::optional<Circuit> validate(const CircuitDecl& decl, const Overrides& overrides,
                                              Diagnostics& diagnostics);

}  // namespace tectum
