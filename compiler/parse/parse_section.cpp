#include "compiler/parse/parse_section.h"

#include <algorithm>
#include <cctype>

#include "compiler/expression/expression.h"

namespace tectum {
namespace {

const std::vector<std::string>& section_names() {
  static const std::vector<std::string> kNames = {
      "references", "parameters", "axes",    "models",  "neurons", "populations", "projections", "inputs",
      "outputs",    "joints",     "lesions", "stimuli", "modules", "instances",   "tables",      "scalings"};
  return kNames;
}

}  // namespace

bool is_section(std::string_view key) {
  return std::find(section_names().begin(), section_names().end(), key) != section_names().end();
}

JsonId find_misspelt_section(const JsonTree& tree, JsonId object, std::string_view key) {
  if (tree[object].kind != JsonKind::Object) {
    return JsonId::None;
  }
  for (JsonId id = tree[object].first_child; id != JsonId::None; id = tree[id].next_sibling) {
    const JsonNode& node = tree[id];
    if (node.kind == JsonKind::Object && !is_section(node.key) && nearest_name(node.key, section_names()) == key) {
      return id;
    }
  }
  return JsonId::None;
}

bool is_identifier(std::string_view text) {
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) != 0) {
    return false;
  }
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') {
      return false;
    }
  }
  return true;
}

}  // namespace tectum
