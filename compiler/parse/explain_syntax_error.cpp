#include "compiler/parse/explain_syntax_error.h"

#include <fmt/format.h>

#include <cctype>
#include <optional>
#include <string>

#include "compiler/parse/text_scan.h"

namespace tectum {
namespace {

Span span_of(const JsonStop& stop, std::size_t begin, std::size_t end) {
  return {stop.file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

/// What stands at `at`, for messages.
std::string token_phrase(std::string_view text, std::size_t at) {
  if (at >= text.size()) {
    return "the end of the file";
  }
  if (text[at] == '"') {
    return "a string";
  }
  return fmt::format("`{}`", text.substr(at, word_end(text, at) - at));
}

/// A string that the reader refused: an escape it does not know, or no closing quote.
void explain_string(const JsonStop& stop, std::size_t at, Diagnostics& diagnostics) {
  const std::string_view text = stop.text;
  const std::size_t end = string_end(text, at);
  for (std::size_t i = at + 1; i < end; ++i) {
    if (text[i] == '\\') {
      const std::size_t length = i + 1 < end && text[i + 1] == 'u' ? std::min<std::size_t>(6, end - i) : 2;
      const bool is_known = i + 1 < end && std::string_view("\"\\/bfnrt").find(text[i + 1]) != std::string_view::npos;
      if (!is_known) {
        bool is_hex = length == 6;
        for (std::size_t k = i + 2; k < i + length && is_hex; ++k) {
          is_hex = std::isxdigit(static_cast<unsigned char>(text[k])) != 0;
        }
        if (!is_hex) {
          diagnostics.add(Code::BadEscape, span_of(stop, i, i + length), {std::string(text.substr(i, length))});
          return;
        }
      }
      ++i;
    } else if (static_cast<unsigned char>(text[i]) < 0x20U) {
      diagnostics
          .add(Code::BadEscape, span_of(stop, i, i + 1), {fmt::format("0x{:02X}", static_cast<unsigned char>(text[i]))})
          .help("write `\\t` for a tab inside a string");
      return;
    }
  }
  if (end > at + 1 && text[end - 1] == '"') {
    // Well formed to the eye: half of a surrogate pair is all that remains.
    diagnostics.add(Code::BadEscape, span_of(stop, at, end), {"half of a surrogate pair"});
    return;
  }
  diagnostics.add(Code::UnclosedString, span_of(stop, at, end));
}

bool starts_number(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '+' || c == '.';
}

/// True when the token itself is malformed, whatever was expected there.
bool explain_malformed(const JsonStop& stop, std::size_t at, const std::string& expected, Diagnostics& diagnostics) {
  const std::string_view text = stop.text;
  const char c = text[at];
  const std::size_t end = word_end(text, at);
  if (c == '/') {
    diagnostics.add(Code::UnexpectedToken, span_of(stop, at, at + 1), {expected, "`/`"})
        .help("comments start with `//` or `/*`");
    return true;
  }
  if (c == '\'') {
    diagnostics.add(Code::UnexpectedToken, span_of(stop, at, at + 1), {expected, "`'`"})
        .help("strings stand in double quotes");
    return true;
  }
  const std::string word(text.substr(at, end - at));
  if (starts_number(c) && !stop.after_value && !stop.after_key) {
    diagnostics.add(Code::BadNumber, span_of(stop, at, end), {word}).help(std::string(kNumberHelp));
    return true;
  }
  if (std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_') {
    if (word == "true" || word == "false" || word == "null") {
      return false;
    }
    auto builder = diagnostics.add(Code::BareWord, span_of(stop, at, end), {word});
    if (word == "True" || word == "False" || word == "None") {
      builder.help("write `true`, `false` or `null`");
    }
    return true;
  }
  return false;
}

/// The comma between `after` and the token at `at`, when there is one.
std::optional<std::size_t> comma_before(const JsonStop& stop, std::size_t at) {
  const std::size_t first = skip_blanks(stop.text, stop.after);
  if (first < at && stop.text[first] == ',') {
    return first;
  }
  return std::nullopt;
}

/// "0.1 ms" without its quotes.
bool is_unit_after_number(const JsonStop& stop, std::size_t at) {
  const std::string_view text = stop.text;
  return std::isalpha(static_cast<unsigned char>(text[at])) != 0 &&
         is_json_number(text.substr(stop.before, stop.after - stop.before)) &&
         text.substr(stop.after, at - stop.after).find('\n') == std::string_view::npos;
}

std::string expectation(const JsonStop& stop, bool has_separator) {
  const bool in_object = !stop.open_brackets.empty() && stop.text[stop.open_brackets.back()] == '{';
  if (stop.after_key && !has_separator) {
    return "`:` after the key";
  }
  if (stop.after_value && !has_separator) {
    return in_object ? "`,` or `}`" : "`,` or `]`";
  }
  if (in_object && !stop.after_key) {
    return has_separator ? "a key in double quotes" : "a key in double quotes or `}`";
  }
  return "a value";
}

void explain_end_of_file(const JsonStop& stop, Diagnostics& diagnostics) {
  const std::size_t end = stop.text.size();
  if (stop.open_brackets.empty()) {
    diagnostics.add(Code::EmptyFile, span_of(stop, 0, 0)).help("a circuit starts with `{ \"tectum\": 1, ... }`");
    return;
  }
  const std::size_t open = stop.open_brackets.back();
  diagnostics.add(Code::UnclosedBracket, span_of(stop, open, open + 1), {std::string(1, stop.text[open])})
      .help(fmt::format("the file ends on line {}", position_of(stop.text, end == 0 ? 0 : end - 1).line));
}

}  // namespace

void explain_syntax_error(const JsonStop& stop, Diagnostics& diagnostics) {
  const std::string_view text = stop.text;
  std::size_t at = skip_blanks(text, stop.after);
  std::optional<char> separator;
  const bool wants_separator = stop.after_key || stop.after_value;
  if (wants_separator && at < text.size() && text[at] == (stop.after_key ? ':' : ',')) {
    separator = text[at];
    at = skip_blanks(text, at + 1);
  }
  if (at >= text.size()) {
    // skip_blanks runs to the end over a comment without one: find where it starts.
    for (std::size_t i = text.find("/*", stop.after); i != std::string_view::npos; i = text.find("/*", i + 2)) {
      if (is_unclosed_comment(text, i)) {
        diagnostics.add(Code::UnclosedComment, span_of(stop, i, i + 2));
        return;
      }
    }
    explain_end_of_file(stop, diagnostics);
    return;
  }
  const char c = text[at];
  const bool closes = c == '}' || c == ']';
  if (closes && separator == ',') {
    const std::size_t comma = comma_before(stop, at).value_or(at);
    diagnostics.add(Code::TrailingComma, span_of(stop, comma, comma + 1), {std::string(1, c)});
    return;
  }
  if (stop.open_brackets.empty() && stop.after_value) {
    diagnostics.add(Code::TextAfterCircuit, span_of(stop, at, word_end(text, at)));
    return;
  }
  const bool starts_value =
      c == '"' || c == '{' || c == '[' || starts_number(c) || std::isalpha(static_cast<unsigned char>(c)) != 0;
  if (stop.after_value && !separator && is_unit_after_number(stop, at)) {
    const std::size_t end = word_end(text, at);
    diagnostics
        .add(Code::BadNumber, span_of(stop, stop.before, end),
             {std::string(text.substr(stop.before, end - stop.before))})
        .help(std::string(kNumberHelp));
    return;
  }
  if (stop.after_value && !separator && starts_value) {
    diagnostics.add(Code::MissingComma, span_of(stop, at, c == '"' ? string_end(text, at) : word_end(text, at)),
                    {token_phrase(text, at)});
    return;
  }
  if (c == '"' && !(stop.after_key && !separator)) {
    explain_string(stop, at, diagnostics);
    return;
  }
  const bool wants_value = stop.after_key ? separator.has_value() : true;
  JsonStop value_stop = stop;
  value_stop.after_key = stop.after_key && !separator;
  value_stop.after_value = stop.after_value && !separator;
  if (wants_value && explain_malformed(value_stop, at, expectation(stop, separator.has_value()), diagnostics)) {
    return;
  }
  auto builder = diagnostics.add(Code::UnexpectedToken, span_of(stop, at, word_end(text, at)),
                                 {expectation(stop, separator.has_value()), token_phrase(text, at)});
  const std::string_view last = text.substr(stop.before, stop.after - stop.before);
  if (stop.after_key && !separator && last.find(':') != std::string_view::npos) {
    builder.help(fmt::format("is a quote missing after `{}`?", last.substr(1, last.find(':') - 1)));
  }
}

}  // namespace tectum
