#include "compiler/diagnostics/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace tectum {
namespace {

// A line is cut to this many columns around its carets, so that a minified file stays readable.
constexpr std::size_t kMaxLineColumns = 160;
constexpr std::size_t kContextColumns = 60;

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// Bytes that a terminal would act on are shown as '?', tabs as one space: one column a code point.
std::string printable(std::string_view line) {
  std::string text;
  for (const char c : line) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte == '\t') {
      text += ' ';
    } else {
      text += byte < 0x20U || byte == 0x7FU ? '?' : c;
    }
  }
  return text;
}

std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return !is_continuation(c); }));
}

/// " 14 |   text" and "    |   ^^^^" for one span; a span over several lines is marked on its first.
std::string excerpt(const Span& span, const Sources& sources) {
  const std::string& bytes = sources.file(span.file).bytes;
  const std::string_view line = line_around(bytes, span.begin);
  const auto line_begin = static_cast<std::size_t>(line.data() - bytes.data());
  const std::size_t from =
      std::min<std::size_t>(span.begin - std::min<std::size_t>(line_begin, span.begin), line.size());
  const std::size_t to = std::clamp<std::size_t>(span.end < line_begin ? 0 : span.end - line_begin, from, line.size());

  std::size_t cut_begin = 0;
  std::size_t cut_end = line.size();
  if (line.size() > kMaxLineColumns) {
    cut_begin = from > kContextColumns ? from - kContextColumns : 0;
    cut_end = std::min(line.size(), cut_begin + kMaxLineColumns);
    while (cut_begin > 0 && is_continuation(line[cut_begin])) {
      --cut_begin;
    }
    while (cut_end < line.size() && is_continuation(line[cut_end])) {
      ++cut_end;
    }
  }
  const std::size_t marked_end = std::min(to, cut_end);
  const std::string_view left_mark = cut_begin > 0 ? "..." : "";
  const std::string_view right_mark = cut_end < line.size() ? "..." : "";
  const std::size_t indent = left_mark.size() + columns(line.substr(cut_begin, from - cut_begin));
  const std::size_t width = std::max<std::size_t>(1, columns(line.substr(from, marked_end - from)));
  const std::string number = fmt::format("{}", position_of(bytes, span.begin).line);
  return fmt::format(" {} | {}{}{}\n {} | {}{}\n", number, left_mark,
                     printable(line.substr(cut_begin, cut_end - cut_begin)), right_mark,
                     std::string(number.size(), ' '), std::string(indent, ' '), std::string(width, '^'));
}

std::string location(const Span& span, const Sources& sources) {
  const SourceFile& file = sources.file(span.file);
  const Position position = position_of(file.bytes, span.begin);
  return fmt::format("{}:{}:{}", file.name, position.line, position.column);
}

std::string_view severity_word(Code code) { return code_info(code).severity == Severity::Error ? "error" : "warning"; }

std::string json_place(const Span& span, const Sources& sources) {
  const SourceFile& file = sources.file(span.file);
  const Position begin = position_of(file.bytes, span.begin);
  const Position end = position_of(file.bytes, span.end);
  return fmt::format(
      R"("file": {}, "line": {}, "column": {}, "end_line": {}, "end_column": {}, "begin": {}, "end": {})",
      json_quoted(file.name), begin.line, begin.column, end.line, end.column, span.begin, span.end);
}

std::string json_diagnostic(const Diagnostic& d, const Sources& sources) {
  std::string text = fmt::format(R"(  {{"code": "{}", "name": "{}", "severity": "{}", "message": {}, {}, "labels": [)",
                                 code_label(d.code), code_info(d.code).name, severity_word(d.code),
                                 json_quoted(d.message()), json_place(d.span, sources));
  for (std::size_t i = 0; i < d.labels.size(); ++i) {
    text += fmt::format("{}{{\"text\": {}, {}}}", i == 0 ? "" : ", ", json_quoted(d.labels[i].text),
                        json_place(d.labels[i].span, sources));
  }
  text += R"(], "help": [)";
  for (std::size_t i = 0; i < d.help.size(); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", json_quoted(d.help[i]));
  }
  return text + "]}";
}

}  // namespace

std::string json_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20U) {
      quoted += fmt::format("\\u{:04x}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string render_text(const Diagnostics& diagnostics, const Sources& sources) {
  std::string text;
  for (const Diagnostic& d : diagnostics.all()) {
    text += fmt::format("{}: {}[{}]: {}\n", location(d.span, sources), severity_word(d.code), code_label(d.code),
                        d.message());
    if (!sources.file(d.span.file).bytes.empty() && d.code != Code::NotText) {
      text += excerpt(d.span, sources);
    }
    for (const Label& label : d.labels) {
      text += fmt::format("    = {}: {}\n", location(label.span, sources), label.text) + excerpt(label.span, sources);
    }
    for (const std::string& help : d.help) {
      text += fmt::format("    = help: {}\n", help);
    }
  }
  return text;
}

std::string render_json(const Diagnostics& diagnostics, const Sources& sources, std::string_view members) {
  std::string text = "{\"diagnostics\": [";
  bool is_first = true;
  for (const Diagnostic& d : diagnostics.all()) {
    text += is_first ? "\n" : ",\n";
    text += json_diagnostic(d, sources);
    is_first = false;
  }
  return text + fmt::format("{}], \"errors\": {}, \"warnings\": {}{}{}}}\n", is_first ? "" : "\n",
                            diagnostics.error_count(), diagnostics.warning_count(), members.empty() ? "" : ",\n ",
                            members);
}

}  // namespace tectum
