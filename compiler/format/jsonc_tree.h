// JSON with comments as a tree in which every comment belongs to an entry or a bracket.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tectum {

struct JsoncComment {
  std::string_view text;
  bool is_line = false;
  bool has_blank_before = false;  // a blank line in the source
  bool ends_line = false;         // a line break follows
};

struct JsoncEntry;

/// A scalar (`text`) or a container. Views point into the input.
struct JsoncValue {
  char bracket = 0;                   // '{', '[', or 0 for a scalar
  std::string_view text;              // scalar
  bool is_one_line = false;           // container without a line break inside, or empty
  std::vector<JsoncComment> opening;  // behind the opening bracket, to the end of its line
  std::vector<JsoncEntry> entries;
  std::vector<JsoncComment> dangling;  // on lines of their own before the closing bracket
  /// Columns on one line; kNotFlat for what cannot be put on one.
  static constexpr std::size_t kNotFlat = std::numeric_limits<std::size_t>::max();
  std::size_t flat_columns = 0;
};

/// One element or member, in source order of its parts.
struct JsoncEntry {
  std::vector<JsoncComment> leading;  // before it: own lines, or inline when ends_line is false
  std::string_view key;               // with its quotes; empty in an array
  std::vector<JsoncComment> between;  // block comments between key and value
  JsoncValue value;
  std::vector<JsoncComment> post;      // block comments between value and comma
  std::vector<JsoncComment> trailing;  // behind the comma, to the end of the line
  bool starts_line = false;            // a line break stood before it
  bool has_blank_before = false;       // before the key or value itself
  std::size_t flat_columns = 0;        // without `trailing` and the comma
};

struct JsoncDocument {
  JsoncEntry root;                  // no key
  std::vector<JsoncComment> after;  // own lines behind the root
  std::size_t error_offset = 0;
  std::string error;  // empty: the tree is whole
};

JsoncDocument parse_jsonc(std::string_view text);

/// Columns of UTF-8 text: its code points.
std::size_t columns_of(std::string_view text);

}  // namespace tectum
