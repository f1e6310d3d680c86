#include "compiler/format/jsonc_tree.h"

#include <algorithm>
#include <utility>

#include "compiler/format/format_circuit.h"
#include "compiler/format/jsonc_tokens.h"

namespace tectum {
namespace {

using Kind = JsoncTokenKind;

bool is_comment(const JsoncToken& token) { return token.kind == Kind::LineComment || token.kind == Kind::BlockComment; }
bool is_multi_line(std::string_view text) { return text.find('\n') != std::string_view::npos; }

std::size_t add_columns(std::size_t a, std::size_t b) {
  return a == JsoncValue::kNotFlat || b == JsoncValue::kNotFlat ? JsoncValue::kNotFlat : a + b;
}

// Each with the blank that parts it from its neighbour.
std::size_t inline_columns(const std::vector<JsoncComment>& comments) {
  std::size_t columns = 0;
  for (const JsoncComment& comment : comments) {
    if (comment.is_line || is_multi_line(comment.text)) {
      return JsoncValue::kNotFlat;
    }
    columns += columns_of(comment.text) + 1;
  }
  return columns;
}

std::size_t entry_columns(const JsoncEntry& entry) {
  std::size_t columns = entry.key.empty() ? 0 : columns_of(entry.key) + 2;
  columns = add_columns(columns, inline_columns(entry.leading));
  columns = add_columns(columns, inline_columns(entry.between));
  columns = add_columns(columns, entry.value.flat_columns);
  return add_columns(columns, inline_columns(entry.post));
}

// "{ a, b }" has a blank inside each bracket, "[a, b]" has none.
std::size_t container_columns(const JsoncValue& value) {
  if (!value.is_one_line) {
    return JsoncValue::kNotFlat;
  }
  std::size_t columns = 2;
  if (value.entries.empty()) {
    const std::size_t comments = inline_columns(value.dangling);
    return comments == 0 ? columns : add_columns(columns + 1, comments);
  }
  if (value.bracket == '{') {
    columns += 2;
  }
  for (const JsoncEntry& entry : value.entries) {
    columns = add_columns(columns, entry.flat_columns);
  }
  return add_columns(columns, 2 * (value.entries.size() - 1));
}

class TreeBuilder {
 public:
  explicit TreeBuilder(JsoncTokens tokens) : tokens_(std::move(tokens.tokens)) {}

  JsoncDocument build() {
    JsoncDocument document;
    read_leading(document.root, 0);
    if (read_value(document.root, 0)) {
      Pending pending = read_behind_value(document.root);
      // Nothing can follow but comments: the first line break ends the root's own.
      for (; is_comment(token()); ++at_) {
        pending.push_back(comment());
      }
      document.after = std::move(pending);
      if (token().kind != Kind::End) {
        fail("expected the end of the file");
      }
    }
    document.error = std::move(error_);
    document.error_offset = error_offset_;
    return document;
  }

 private:
  using Pending = std::vector<JsoncComment>;

  const JsoncToken& token() const { return tokens_[at_]; }

  bool fail(std::string error) {
    if (error_.empty()) {
      error_ = std::move(error);
      error_offset_ = token().offset;
    }
    return false;
  }

  // The comment at at_. The next token tells whether a line break follows.
  JsoncComment comment() const {
    const JsoncToken& t = token();
    const bool is_line = t.kind == Kind::LineComment;
    const bool ends_line = is_line || tokens_[at_ + 1].newlines_before > 0 || is_multi_line(t.text);
    return {t.text, is_line, t.newlines_before > 1, ends_line};
  }

  // True when the comments at at_ that stand on the line of the token before run to the end of that line.
  bool comments_end_line() const {
    std::size_t i = at_;
    if (!is_comment(tokens_[i]) || tokens_[i].newlines_before > 0) {
      return false;
    }
    while (is_comment(tokens_[i])) {
      ++i;
      if (tokens_[i].newlines_before > 0) {
        return true;
      }
    }
    return false;
  }

  void read_to_line_end(std::vector<JsoncComment>& comments) {
    if (!comments_end_line()) {
      return;
    }
    do {
      comments.push_back(comment());
      ++at_;
    } while (token().newlines_before == 0 && is_comment(token()));
  }

  void read_leading(JsoncEntry& entry, std::size_t first_token) {
    for (; is_comment(token()); ++at_) {
      entry.leading.push_back(comment());
    }
    for (std::size_t i = first_token; i <= at_; ++i) {
      entry.starts_line |= tokens_[i].newlines_before > 0;
    }
    entry.has_blank_before = token().newlines_before > 1;
  }

  bool read_value(JsoncEntry& entry, int depth) {
    const Kind kind = token().kind;
    bool is_fine = true;
    if (kind == Kind::String || kind == Kind::Literal) {
      entry.value.text = token().text;
      entry.value.flat_columns = columns_of(token().text);
      ++at_;
    } else if (kind == Kind::OpenObject || kind == Kind::OpenArray) {
      is_fine = depth < kMaxFormatDepth ? read_container(entry.value, depth)
                                        : fail("nested deeper than " + std::to_string(kMaxFormatDepth) + " levels");
    } else {
      is_fine = fail(kind == Kind::End ? "expected a value, the file ends here" : "expected a value");
    }
    entry.flat_columns = entry_columns(entry);
    return is_fine;
  }

  bool read_container(JsoncValue& value, int depth) {
    const std::size_t open = at_;
    value.bracket = token().text[0];
    const Kind close = value.bracket == '{' ? Kind::CloseObject : Kind::CloseArray;
    ++at_;
    read_to_line_end(value.opening);
    Pending pending;
    std::size_t entry_begin = at_;
    bool may_close = true;  // not behind a comma
    while (true) {
      JsoncEntry entry;
      entry.leading = std::exchange(pending, {});
      read_leading(entry, entry_begin);
      if (token().kind == close) {
        if (!may_close) {
          return fail("comma before a closing bracket");
        }
        value.dangling = std::move(entry.leading);
        break;
      }
      if (token().kind == Kind::End) {
        at_ = open;
        return fail("bracket is never closed");
      }
      if (!value.entries.empty() && may_close) {
        return fail("expected `,` or a closing bracket");
      }
      if ((value.bracket == '{' && !read_key(entry)) || !read_value(entry, depth + 1)) {
        return false;
      }
      entry_begin = at_;
      pending = read_behind_value(entry);
      may_close = token().kind != Kind::Comma;
      if (!may_close) {
        ++at_;
        // A comment that comes after a pending one must stay after it.
        read_to_line_end(pending.empty() ? entry.trailing : pending);
      }
      entry.flat_columns = entry_columns(entry);
      value.entries.push_back(std::move(entry));
    }
    value.is_one_line = is_one_line(value, open);
    value.flat_columns = container_columns(value);
    ++at_;
    return true;
  }

  bool is_one_line(const JsoncValue& value, std::size_t open) const {
    if (value.entries.empty() && value.opening.empty() && value.dangling.empty()) {
      return true;
    }
    for (std::size_t i = open + 1; i <= at_; ++i) {
      if (tokens_[i].newlines_before > 0 || is_multi_line(tokens_[i].text)) {
        return false;
      }
    }
    return true;
  }

  bool read_key(JsoncEntry& entry) {
    if (token().kind != Kind::String) {
      return fail("expected a key in double quotes");
    }
    entry.key = token().text;
    ++at_;
    std::vector<JsoncComment> between;
    for (; is_comment(token()); ++at_) {
      between.push_back(comment());
    }
    if (token().kind != Kind::Colon) {
      return fail("expected `:` after the key");
    }
    ++at_;
    for (; is_comment(token()); ++at_) {
      between.push_back(comment());
    }
    if (inline_columns(between) != JsoncValue::kNotFlat) {
      entry.between = std::move(between);
      return true;
    }
    // A comment to the end of the line cannot stay there: the whole run moves before the key.
    for (JsoncComment& moved : between) {
      moved.ends_line = true;
      entry.leading.push_back(moved);
    }
    for (JsoncComment& before : entry.leading) {
      before.ends_line = true;
    }
    return true;
  }

  // Comments between a value and its comma or bracket. Returns those that do not stand on its line.
  Pending read_behind_value(JsoncEntry& entry) {
    Pending pending;
    for (; is_comment(token()); ++at_) {
      const bool is_beside = pending.empty() && entry.trailing.empty() && token().newlines_before == 0;
      if (!is_beside) {
        pending.push_back(comment());
        pending.back().ends_line = true;
      } else {
        (token().kind == Kind::LineComment ? entry.trailing : entry.post).push_back(comment());
      }
    }
    return pending;
  }

  std::vector<JsoncToken> tokens_;
  std::size_t at_ = 0;
  std::string error_;
  std::size_t error_offset_ = 0;
};

}  // namespace

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80; }));
}

JsoncDocument parse_jsonc(std::string_view text) {
  JsoncTokens tokens = tokenize_jsonc(text);
  if (!tokens.error.empty()) {
    JsoncDocument document;
    document.error = std::move(tokens.error);
    document.error_offset = tokens.error_offset;
    return document;
  }
  return TreeBuilder(std::move(tokens)).build();
}

}  // namespace tectum
