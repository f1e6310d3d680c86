// What a test expects of a number: "< 80 ms", "10 deg ± 1", "50 to 130 Hz".
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "compiler/validate/scope.h"

namespace tectum {

/// Written as a text:
///   "< 80 ms", "<= 80 ms", "> 1 deg", ">= 1 deg"
///   "10 deg ± 1"       also "+-"; the tolerance in the value's own unit, or with a unit, or in % of the value
///   "50 to 130 Hz"     both ends belong to it; one unit is enough
struct Bound {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool excludes_ends = false;
  std::string text;  // as written

  [[nodiscard]] bool holds(double value) const {
    return excludes_ends ? value > low && value < high : value >= low && value <= high;
  }
};

/// In coherent units. `key` names the value in messages. Reports what is wrong.
[[nodiscard]] std::optional<Bound> read_bound(const ValueDecl& value, std::string_view key, const Dimension& dimension,
                                              Scope& scope);

/// "95.3 ms": what was seen, to four digits. `is_share` shows a plain number in %.
[[nodiscard]] std::string seen_text(double coherent, const Dimension& dimension, bool is_share);

}  // namespace tectum
