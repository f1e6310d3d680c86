// Which population is the mirror image of which.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/validate/circuit.h"

namespace tectum {

/// `name` with the words for the two sides swapped: "SC_left" becomes "SC_right". Words end at `_`, `-` and `.`; left
/// and right may also be written L and R, or l and r.
[[nodiscard]] std::string swap_side_words(std::string_view name, const std::pair<std::string, std::string>& sides);

/// For each instance its mirror image: the same population on the other side of `axes`, where two populations
/// differ by the words for the sides ("SC_left", "SC_right") that other population, or both. Itself where it has none.
[[nodiscard]] std::vector<std::size_t> mirror_partners(const Circuit& circuit, const std::vector<AxisId>& axes,
                                                       const std::pair<std::string, std::string>& sides);

/// Are there two populations of the same kind whose names differ by the words for these sides?
[[nodiscard]] bool has_named_pairs(const Circuit& circuit, const std::pair<std::string, std::string>& sides);

}  // namespace tectum
