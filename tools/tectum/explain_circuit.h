#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/compile.h"

namespace tectum {

/// Where a population or a projection of the circuit comes from: each value with the line that gives it, what joins it
/// to the rest, and its sources. Nothing when the circuit has no such name. Needs: a result with its network.
[[nodiscard]] std::optional<std::string> explain_name(const CompileResult& result, const std::string& name);

/// Every population and projection, for suggestions.
[[nodiscard]] std::vector<std::string> explainable_names(const CompileResult& result);

}  // namespace tectum
