// A number with what it measures.
#pragma once

#include <string>

#include "compiler/expression/dimension.h"

namespace tectum {

/// `value` is in the coherent unit of `dimension` (see dimension.h). A truth value is 0 or 1, a
/// word is the small integer that the environment gave it.
struct Quantity {
  double value = 0;
  Dimension dimension;
  friend bool operator==(const Quantity&, const Quantity&) = default;
};

/// "0.9 nA", "20 ms", "250 Hz", "0.05": the shortest decimal that reads back to the same value in
/// the display unit. Truth values print as true and false, words as their number.
std::string format_quantity(const Quantity& quantity);

}  // namespace tectum
