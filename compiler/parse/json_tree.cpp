#include "compiler/parse/json_tree.h"

#include <fmt/format.h>

namespace tectum {
namespace {

void dump_node(const JsonTree& tree, JsonId id, std::size_t depth, std::string& text) {
  const JsonNode& node = tree[id];
  text += fmt::format("{:>8}..{:<8}{}", node.span.begin, node.span.end, std::string(2 * depth, ' '));
  if (!node.key.empty()) {
    text += node.key + ": ";
  }
  switch (node.kind) {
    case JsonKind::Null:
      text += "null";
      break;
    case JsonKind::Boolean:
      text += node.boolean ? "true" : "false";
      break;
    case JsonKind::Number:
      text += node.text;
      break;
    case JsonKind::String:
      text += '"' + node.text + '"';
      break;
    case JsonKind::Array:
      text += fmt::format("[{}]", node.child_count);
      break;
    case JsonKind::Object:
      text += fmt::format("{{{}}}", node.child_count);
      break;
  }
  text += '\n';
  for (JsonId child = node.first_child; child != JsonId::None; child = tree[child].next_sibling) {
    dump_node(tree, child, depth + 1, text);
  }
}

}  // namespace

JsonId JsonTree::find(JsonId object, std::string_view key) const {
  for (JsonId child = (*this)[object].first_child; child != JsonId::None; child = (*this)[child].next_sibling) {
    if ((*this)[child].key == key) {
      return child;
    }
  }
  return JsonId::None;
}

std::string_view kind_phrase(JsonKind kind) {
  switch (kind) {
    case JsonKind::Null:
      return "null";
    case JsonKind::Boolean:
      return "true or false";
    case JsonKind::Number:
      return "a number";
    case JsonKind::String:
      return "a string";
    case JsonKind::Array:
      return "a list";
    case JsonKind::Object:
      return "an object";
  }
  return "";
}

std::string dump_json_tree(const JsonTree& tree) {
  std::string text;
  if (tree.root() != JsonId::None) {
    dump_node(tree, tree.root(), 0, text);
  }
  return text;
}

}  // namespace tectum
