// A JSON text as flat nodes, each with the bytes it came from. Later stages read no JSON again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/source/source_file.h"

namespace tectum {

enum class JsonId : std::uint32_t { None = 0xFFFFFFFFU };
enum class JsonKind : std::uint8_t { Null, Boolean, Number, String, Array, Object };

struct JsonNode {
  JsonKind kind = JsonKind::Null;
  bool has_escapes = false;  // String: byte offsets in `text` are not byte offsets in the file
  bool boolean = false;
  std::uint32_t child_count = 0;
  JsonId first_child = JsonId::None;
  JsonId next_sibling = JsonId::None;
  Span span;         // the value; a string with its quotes
  Span key_span;     // member of an object: its key with the quotes
  std::string key;   // member of an object
  std::string text;  // String: decoded; Number: as written
  double number = 0;
};

/// Nodes in the order of the text, the root first. Children hang on a list.
struct JsonTree {
  std::vector<JsonNode> nodes;
  bool is_whole = true;  // false when a file that belongs to it could not be read

  [[nodiscard]] const JsonNode& operator[](JsonId id) const { return nodes[static_cast<std::size_t>(id)]; }
  [[nodiscard]] JsonNode& operator[](JsonId id) { return nodes[static_cast<std::size_t>(id)]; }
  [[nodiscard]] JsonId root() const { return nodes.empty() ? JsonId::None : JsonId{0}; }
  [[nodiscard]] JsonId find(JsonId object, std::string_view key) const;
};

/// "a string", "a list", ... for messages.
[[nodiscard]] std::string_view kind_phrase(JsonKind kind);

/// Indented text of the tree, one node a line with its span, for `dump`.
[[nodiscard]] std::string dump_json_tree(const JsonTree& tree);

}  // namespace tectum
