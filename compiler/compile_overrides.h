#pragma once

#include "compiler/compile.h"
#include "compiler/validate/validate.h"

namespace tectum {

/// Turns the command line's seed, lesions and parameters into declarations. Each text becomes a source of its own,
/// so that a mistake in it is shown like one in a file.
[[nodiscard]] Overrides make_overrides(const CompileOptions& options, Sources& sources, Diagnostics& diagnostics);

}  // namespace tectum
