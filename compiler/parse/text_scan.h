// Finding the tokens of a JSON text again, to say where they are. Knows no grammar.
#pragma once

#include <cstddef>
#include <string_view>

namespace tectum {

/// First offset at or after `at` that is neither blank nor inside a comment. An unclosed comment ends the text.
[[nodiscard]] std::size_t skip_blanks(std::string_view text, std::size_t at);
/// True when a comment that starts at `at` has no end; `at` must point at its '/'.
[[nodiscard]] bool is_unclosed_comment(std::string_view text, std::size_t at);
/// Offset just after the string whose opening quote is at `at`; the end of the line when it is not closed.
[[nodiscard]] std::size_t string_end(std::string_view text, std::size_t at);
/// Offset just after the run of letters, digits, signs and points at `at`; at least at + 1.
[[nodiscard]] std::size_t word_end(std::string_view text, std::size_t at);
/// True for a number as JSON writes it: no leading zero or plus, digits on both sides of the point.
[[nodiscard]] bool is_json_number(std::string_view word);
/// Offset of the first byte that starts no UTF-8 sequence, or npos.
[[nodiscard]] std::size_t find_invalid_utf8(std::string_view text);

}  // namespace tectum
