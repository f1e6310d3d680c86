#pragma once

#include <optional>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/json_tree.h"

namespace tectum {

inline constexpr int kMaxJsonDepth = 64;

/// Reads JSON with // and /* */ comments. Reports the first syntax error, or every key that appears
/// twice in its object, and then returns nothing. Stops at kMaxJsonDepth, so that hostile text costs little.
[[nodiscard]] std::optional<JsonTree> parse_json(const Sources& sources, FileId file, Diagnostics& diagnostics);

}  // namespace tectum
