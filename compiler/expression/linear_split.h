// An expression as offset + sum of slope_k * variable_k, where it is one.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "compiler/expression/expression.h"

namespace tectum {

/// Parts that are identically zero are absent. The parts do not contain the variables.
struct LinearSplit {
  std::vector<std::optional<Expression>> slopes;  // one a variable
  std::optional<Expression> offset;
  std::optional<ExprSpan> nonlinear;  // the smallest part that is not linear; then the rest is empty
};

/// `variable_of` gives a name's index below `variable_count`, or nothing. Judges by form, not by value:
/// "v * v" is not linear, "v * k" is, whatever k.
LinearSplit split_linear(const Expression& expression, std::size_t variable_count,
                         const std::function<std::optional<std::size_t>(std::string_view)>& variable_of);

}  // namespace tectum
