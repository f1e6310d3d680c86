#pragma once

#include <set>
#include <string>

#include "tools/diff/circuit_view.h"
#include "tools/report/connectome_picture.h"

namespace tectum {

/// What the view's wiring diagram shows. Populations ("EBN", or one side of it) and projections in `set_off` are drawn
/// in `ink`, a role of tools/report/theme.h.
[[nodiscard]] Connectome connectome_of(const CircuitView& view, const std::set<std::string>& set_off = {},
                                       const std::string& ink = "c3");

}  // namespace tectum
