// `tectum fmt`: lays a circuit file out without changing what it says.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tectum {

/// The formatted text, or why there is none and at which byte of the input.
struct FormattedCircuit {
  std::optional<std::string> text;
  std::size_t error_offset = 0;
  std::string error;  // lower case, no full stop
};

/// Formats JSON with // and /* */ comments. Keeps keys, values and their order byte for byte, and every
/// comment in its place; formatting the result again changes nothing.
///
///   - two blanks of indentation; `{ "a": 1 }`, `[1, 2]`, `"key": value`
///   - what stood on one line stays there when it fits 120 columns; else arrays of plain values and objects that hold
///     more than objects are filled, and others get a line an entry
///   - what stood on several lines keeps its line breaks between entries
///   - at most one blank line, none beside a bracket; one newline at the end
///
/// Takes exactly what a JSON parser with comments takes, to kMaxFormatDepth levels.
FormattedCircuit format_circuit(std::string_view text);

inline constexpr int kMaxFormatDepth = 256;

}  // namespace tectum
