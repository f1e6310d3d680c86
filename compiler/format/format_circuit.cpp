#include "compiler/format/format_circuit.h"

#include <algorithm>
#include <cctype>

#include "compiler/format/jsonc_tree.h"

namespace tectum {
namespace {

constexpr std::size_t kLineColumns = 120;
constexpr std::size_t kIndentColumns = 2;

bool is_multi_line(const std::vector<JsoncComment>& comments) {
  return std::any_of(comments.begin(), comments.end(),
                     [](const JsoncComment& c) { return c.text.find('\n') != std::string_view::npos; });
}

std::string_view without_blanks(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) {
    return {};
  }
  return line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

class Printer {
 public:
  std::string print(const JsoncDocument& document) {
    print_entry(document.root, 0, false);
    print_trailing(document.root.trailing);
    print_own_lines(document.after, 0, true);
    out_ += '\n';
    return std::move(out_);
  }

 private:
  // ---- places ----
  void new_line(std::size_t indent) {
    out_ += '\n';
    line_begin_ = out_.size();
    out_.append(indent, ' ');
  }
  void blank_line() { out_ += '\n'; }
  std::size_t column() const { return columns_of(std::string_view(out_).substr(line_begin_)); }

  // ---- comments ----
  void print_comment(const JsoncComment& comment, std::size_t indent) {
    const std::vector<std::string_view> lines = lines_of(comment.text);
    const bool is_starred = std::all_of(lines.begin() + 1, lines.end(),
                                        [](std::string_view line) { return without_blanks(line).substr(0, 1) == "*"; });
    out_ += lines.size() == 1 ? lines[0] : lines[0].substr(0, lines[0].find_last_not_of('\r') + 1);
    for (std::size_t i = 1; i < lines.size(); ++i) {
      if (is_starred) {
        new_line(indent + 1);
        out_ += without_blanks(lines[i]);
      } else {
        new_line(0);
        out_ += lines[i].substr(0, lines[i].find_last_not_of('\r') + 1);
      }
    }
  }

  void print_trailing(const std::vector<JsoncComment>& comments) {
    for (std::size_t i = 0; i < comments.size(); ++i) {
      out_ += i == 0 ? "  " : " ";
      print_comment(comments[i], 0);
    }
  }

  // Each run of comments that shared a line shares one again.
  void print_own_lines(const std::vector<JsoncComment>& comments, std::size_t indent, bool may_be_blank) {
    bool continues_line = false;
    for (const JsoncComment& comment : comments) {
      if (continues_line) {
        out_ += ' ';
      } else {
        if (comment.has_blank_before && may_be_blank) {
          blank_line();
        }
        new_line(indent);
      }
      print_comment(comment, indent);
      continues_line = !comment.ends_line;
      may_be_blank = true;
    }
  }

  // ---- entries ----
  void print_entry(const JsoncEntry& entry, std::size_t indent, bool has_comma) {
    for (std::size_t i = 0; i < entry.leading.size(); ++i) {
      const JsoncComment& comment = entry.leading[i];
      print_comment(comment, indent);
      if (!comment.ends_line) {
        out_ += ' ';
        continue;
      }
      const bool is_last = i + 1 == entry.leading.size();
      if (is_last ? entry.has_blank_before : entry.leading[i + 1].has_blank_before) {
        blank_line();
      }
      new_line(indent);
    }
    if (!entry.key.empty()) {
      out_ += entry.key;
      out_ += ": ";
    }
    for (const JsoncComment& comment : entry.between) {
      out_ += comment.text;
      out_ += ' ';
    }
    print_value(entry.value, indent);
    for (const JsoncComment& comment : entry.post) {
      out_ += ' ';
      print_comment(comment, 0);
    }
    if (has_comma) {
      out_ += ',';
    }
  }

  void print_value(const JsoncValue& value, std::size_t indent) {
    if (value.bracket == 0) {
      out_ += value.text;
    } else if (value.flat_columns != JsoncValue::kNotFlat && column() + value.flat_columns + 1 <= kLineColumns) {
      print_flat(value);
    } else {
      print_broken(value, indent);
    }
  }

  void print_flat(const JsoncValue& value) {
    const bool is_object = value.bracket == '{';
    out_ += value.bracket;
    if (value.entries.empty()) {
      for (const JsoncComment& comment : value.dangling) {
        (out_ += ' ') += comment.text;
      }
      if (!value.dangling.empty()) {
        out_ += ' ';
      }
    } else {
      if (is_object) {
        out_ += ' ';
      }
      for (std::size_t i = 0; i < value.entries.size(); ++i) {
        if (i > 0) {
          out_ += ' ';
        }
        print_flat_entry(value.entries[i], i + 1 < value.entries.size());
      }
      if (is_object) {
        out_ += ' ';
      }
    }
    out_ += is_object ? '}' : ']';
  }

  void print_flat_entry(const JsoncEntry& entry, bool has_comma) {
    for (const JsoncComment& comment : entry.leading) {
      (out_ += comment.text) += ' ';
    }
    if (!entry.key.empty()) {
      (out_ += entry.key) += ": ";
    }
    for (const JsoncComment& comment : entry.between) {
      (out_ += comment.text) += ' ';
    }
    if (entry.value.bracket == 0) {
      out_ += entry.value.text;
    } else {
      print_flat(entry.value);
    }
    for (const JsoncComment& comment : entry.post) {
      (out_ += ' ') += comment.text;
    }
    if (has_comma) {
      out_ += ',';
    }
  }

  void print_broken(const JsoncValue& value, std::size_t indent) {
    const std::size_t inner = indent + kIndentColumns;
    const auto is_plain = [&](const JsoncEntry& entry) {
      return entry.value.bracket == 0 || (value.bracket == '{' && entry.value.bracket == '[');
    };
    const bool is_filled = value.bracket == '[' ? std::all_of(value.entries.begin(), value.entries.end(), is_plain)
                                                : std::any_of(value.entries.begin(), value.entries.end(), is_plain);
    // From one line that became too long; the author set no line breaks to keep.
    const bool is_entry_a_line = value.is_one_line && !is_filled;
    out_ += value.bracket;
    print_trailing(value.opening);
    bool must_break = true;  // the entry before takes the rest of its line
    for (std::size_t i = 0; i < value.entries.size(); ++i) {
      const JsoncEntry& entry = value.entries[i];
      const bool fits_a_line =
          entry.flat_columns != JsoncValue::kNotFlat && inner + entry.flat_columns + 1 <= kLineColumns;
      const bool fits_here = fits_a_line && column() + 1 + entry.flat_columns + 1 <= kLineColumns;
      if (must_break || is_entry_a_line || entry.starts_line || !fits_here) {
        const bool has_blank = entry.leading.empty() ? entry.has_blank_before : entry.leading[0].has_blank_before;
        if (has_blank && i > 0) {
          blank_line();
        }
        new_line(inner);
      } else {
        out_ += ' ';
      }
      print_entry(entry, inner, i + 1 < value.entries.size());
      print_trailing(entry.trailing);
      must_break = !fits_a_line || !entry.trailing.empty() || is_multi_line(entry.post);
    }
    print_own_lines(value.dangling, inner, !value.entries.empty());
    new_line(indent);
    out_ += value.bracket == '{' ? '}' : ']';
  }

  std::string out_;
  std::size_t line_begin_ = 0;
};

}  // namespace

FormattedCircuit format_circuit(std::string_view text) {
  const JsoncDocument document = parse_jsonc(text);
  if (!document.error.empty()) {
    return {std::nullopt, document.error_offset, document.error};
  }
  return {Printer().print(document), 0, {}};
}

}  // namespace tectum
