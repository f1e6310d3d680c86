#include "compiler/parse/object_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "compiler/diagnostics/counted.h"
#include "compiler/expression/expression.h"

namespace tectum {
namespace {

Span key_inner_span(const JsonNode& node) {
  return {node.key_span.file, node.key_span.begin + 1, node.key_span.end - 1};
}

}  // namespace

Span inner_span(const JsonNode& node) {
  if (node.kind != JsonKind::String) {
    return node.span;
  }
  return {node.span.file, node.span.begin + 1, node.span.end - 1};
}

ObjectReader::ObjectReader(const JsonTree& tree, JsonId object, std::string what, Diagnostics& diagnostics)
    : tree_(tree), object_(object), what_(std::move(what)), diagnostics_(diagnostics) {
  is_object_ = tree[object].kind == JsonKind::Object;
  if (!is_object_) {
    diagnostics.add(Code::WrongType, tree[object].span,
                    {what_, std::string(kind_phrase(tree[object].kind)), "an object"});
  }
}

bool ObjectReader::has(std::string_view key) const { return is_object_ && tree_.find(object_, key) != JsonId::None; }

JsonId ObjectReader::child(std::string_view key) {
  known_.emplace_back(key);
  return is_object_ ? tree_.find(object_, key) : JsonId::None;
}

void ObjectReader::report_type(JsonId id, std::string_view key, std::string_view expected) {
  diagnostics_.add(Code::WrongType, tree_[id].span,
                   {fmt::format("`{}`", key), std::string(kind_phrase(tree_[id].kind)), std::string(expected)});
}

void ObjectReader::report_missing(std::string_view key) {
  // One message for all that is missing comes from finish(); what is no object has been reported.
  if (is_object_) {
    missing_.emplace_back(key);
  }
}

NameDecl ObjectReader::name_of(JsonId id, std::string_view key) {
  const JsonNode& node = tree_[id];
  if (node.kind != JsonKind::String) {
    report_type(id, key, "a string");
    return {"", node.span, true};
  }
  return {node.text, inner_span(node)};
}

ValueDecl ObjectReader::value_of(JsonId id, std::string_view key) {
  const JsonNode& node = tree_[id];
  ValueDecl value;
  value.span = inner_span(node);
  if (node.kind != JsonKind::String && node.kind != JsonKind::Number) {
    report_type(id, key, "a number or a string");
    value.is_poisoned = true;
    return value;
  }
  value.is_number = node.kind == JsonKind::Number;
  value.number = node.number;
  value.text = node.text;
  value.has_exact_offsets = !node.has_escapes;
  return value;
}

std::optional<NameDecl> ObjectReader::name(std::string_view key) {
  const JsonId id = child(key);
  return id == JsonId::None ? std::nullopt : std::optional(name_of(id, key));
}

std::optional<ValueDecl> ObjectReader::value(std::string_view key) {
  const JsonId id = child(key);
  return id == JsonId::None ? std::nullopt : std::optional(value_of(id, key));
}

std::vector<NameDecl> ObjectReader::names(std::string_view key) {
  std::vector<NameDecl> result;
  const JsonId id = child(key);
  if (id == JsonId::None) {
    return result;
  }
  if (tree_[id].kind == JsonKind::String) {
    return {name_of(id, key)};
  }
  if (tree_[id].kind != JsonKind::Array) {
    report_type(id, key, "a string or a list of strings");
    return {{"", tree_[id].span, true}};
  }
  if (tree_[id].child_count == 0) {
    diagnostics_.add(Code::EmptyList, tree_[id].span, {fmt::format("`{}`", key)});
    return {{"", tree_[id].span, true}};
  }
  for (JsonId item = tree_[id].first_child; item != JsonId::None; item = tree_[item].next_sibling) {
    result.push_back(name_of(item, key));
  }
  return result;
}

std::vector<ValueDecl> ObjectReader::values(std::string_view key, std::size_t count) {
  std::vector<ValueDecl> result;
  const JsonId id = child(key);
  if (id == JsonId::None) {
    return result;
  }
  ValueDecl poisoned;
  poisoned.span = tree_[id].span;
  poisoned.is_poisoned = true;
  if (tree_[id].kind != JsonKind::Array) {
    report_type(id, key, count == 0 ? "a list" : fmt::format("a list of {}", count));
    return std::vector<ValueDecl>(count, poisoned);
  }
  if (count != 0 && tree_[id].child_count != count) {
    diagnostics_.add(Code::WrongCount, tree_[id].span,
                     {fmt::format("`{}`", key), counted(tree_[id].child_count, "value"), fmt::format("{}", count)});
    return std::vector<ValueDecl>(count, poisoned);
  }
  for (JsonId item = tree_[id].first_child; item != JsonId::None; item = tree_[item].next_sibling) {
    result.push_back(value_of(item, key));
  }
  return result;
}

std::string ObjectReader::text(std::string_view key) {
  auto decl = name(key);
  return decl ? std::move(decl->text) : std::string();
}

ProvenanceDecl ObjectReader::provenance() { return {names("cite"), text("about")}; }

NameDecl ObjectReader::required_name(std::string_view key) {
  auto decl = name(key);
  if (!decl) {
    report_missing(key);
  }
  return decl.value_or(NameDecl{"", span(), true});
}

ValueDecl ObjectReader::required_value(std::string_view key) {
  auto decl = value(key);
  if (decl) {
    return *decl;
  }
  report_missing(key);
  ValueDecl missing;
  missing.span = span();
  missing.is_poisoned = true;
  return missing;
}

std::vector<NameDecl> ObjectReader::required_names(std::string_view key) {
  auto decl = names(key);
  if (decl.empty()) {
    report_missing(key);
    decl.push_back({"", span(), true});
  }
  return decl;
}

std::vector<KeyedValue> ObjectReader::rest() {
  std::vector<KeyedValue> result;
  if (!is_object_) {
    return result;
  }
  for (JsonId id = tree_[object_].first_child; id != JsonId::None; id = tree_[id].next_sibling) {
    const JsonNode& node = tree_[id];
    if (std::find(known_.begin(), known_.end(), node.key) != known_.end()) {
      continue;
    }
    rest_.push_back(node.key);
    KeyedValue keyed;
    keyed.key = {node.key, key_inner_span(node)};
    keyed.span = inner_span(node);
    keyed.is_list = node.kind == JsonKind::Array;
    if (keyed.is_list) {
      for (JsonId item = node.first_child; item != JsonId::None; item = tree_[item].next_sibling) {
        keyed.values.push_back(value_of(item, node.key));
      }
    } else if (node.kind == JsonKind::Boolean) {
      keyed.values.push_back({false, 0, node.boolean ? "true" : "false", node.span, true});
    } else {
      keyed.values.push_back(value_of(id, node.key));
    }
    result.push_back(std::move(keyed));
  }
  return result;
}

JsonId ObjectReader::misspelt(std::string_view key) const {
  const std::vector<std::string> meant = {std::string(key)};
  for (JsonId id = tree_[object_].first_child; id != JsonId::None; id = tree_[id].next_sibling) {
    const std::string& written = tree_[id].key;
    if (std::find(known_.begin(), known_.end(), written) == known_.end() && nearest_name(written, meant)) {
      return id;
    }
  }
  return JsonId::None;
}

void ObjectReader::finish() {
  if (!is_object_) {
    return;
  }
  for (JsonId id = tree_[object_].first_child; id != JsonId::None; id = tree_[id].next_sibling) {
    const JsonNode& node = tree_[id];
    const bool is_known = std::find(known_.begin(), known_.end(), node.key) != known_.end();
    if (!is_known && std::find(rest_.begin(), rest_.end(), node.key) == rest_.end()) {
      diagnostics_.add(Code::UnknownKey, key_inner_span(node), {node.key, what_})
          .help_if(nearest_name(node.key, known_), "did you mean `{}`?");
    }
  }
  for (const std::string& key : missing_) {
    if (const JsonId id = misspelt(key); id != JsonId::None) {
      // A key that rest() took may be right elsewhere; here it stands in the place of one that is needed.
      if (std::find(rest_.begin(), rest_.end(), tree_[id].key) != rest_.end()) {
        diagnostics_.add(Code::UnknownKey, key_inner_span(tree_[id]), {tree_[id].key, what_})
            .help(fmt::format("did you mean `{}`?", key));
      }
      continue;
    }
    const Span span = tree_[object_].key_span.end > 0
                          ? key_inner_span(tree_[object_])
                          : Span{tree_[object_].span.file, tree_[object_].span.begin, tree_[object_].span.begin + 1};
    diagnostics_.add(Code::MissingKey, span, {what_, key});
  }
}

}  // namespace tectum
