#pragma once

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/circuit_decl.h"

namespace tectum {

/// Writes every module instance into the circuit: population EBN of instance `left_gen` becomes `left_gen.EBN`, a port
/// becomes the populations bound to it, and values see the instance's parameters first. Fills decl.scopes.
void expand_modules(CircuitDecl& decl, Diagnostics& diagnostics);

}  // namespace tectum
