#pragma once

#include <cstdint>
#include <vector>

#include "compiler/expression/expression.h"

namespace tectum {

/// The variables that an expression reads, ascending.
[[nodiscard]] std::vector<std::uint32_t> slots_read(const TypedExpression& expression);

}  // namespace tectum
