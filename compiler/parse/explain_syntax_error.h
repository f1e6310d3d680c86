#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"

namespace tectum {

/// How numbers are written.
inline constexpr std::string_view kNumberHelp =
    "write numbers like `0.5`, `-2` or `1e-3`; a quantity with a unit is a string: \"5 ms\"";

/// Where a JSON reader stood when it gave up.
struct JsonStop {
  FileId file{};
  std::string_view text;
  std::size_t before = 0;                  // start of the last token that was understood
  std::size_t after = 0;                   // its end
  bool after_key = false;                  // that token was a key
  bool after_value = false;                // that token was a value, or closed one
  std::vector<std::size_t> open_brackets;  // offsets of the brackets still open, outermost first
};

/// Says in our words what is wrong at the first token that does not fit.
void explain_syntax_error(const JsonStop& stop, Diagnostics& diagnostics);

}  // namespace tectum
