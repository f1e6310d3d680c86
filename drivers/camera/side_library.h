// Parts of the binary that pull in many shared libraries lie beside it in libraries of their own, loaded when first
// used.
#pragma once

namespace tectum {

/// Looks for `name` beside the binary, else one folder up (where a build leaves it for its tests), else where the
/// system looks. Null when it cannot be loaded; dlerror() says why.
[[nodiscard]] void* open_side_library(const char* name);

}  // namespace tectum
