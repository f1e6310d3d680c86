#pragma once

#include <string>

#include "tools/diff/structure_diff.h"

namespace tectum {

/// {"first", "second", "same", "changes": [{kind, element, name, where, property, before, after, detail, group, place,
/// because}]}. Does not end in a newline.
[[nodiscard]] std::string diff_json(const CircuitView& a, const CircuitView& b, const StructureDiff& structure);

}  // namespace tectum
