#include "compiler/parse/object_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

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

std::optional<NameDecl> ObjectReader::name_of(JsonId id, std::string_view key) {
  const JsonNode& node = tree_[id];
  if (node.kind != JsonKind::String) {
    report_type(id, key, "a string");
    return std::nullopt;
  }
  return NameDecl{node.text, inner_span(node)};
}

std::optional<ValueDecl> ObjectReader::value_of(JsonId id, std::string_view key) {
  const JsonNode& node = tree_[id];
  if (node.kind != JsonKind::String && node.kind != JsonKind::Number) {
    report_type(id, key, "a number or a string");
    return std::nullopt;
  }
  ValueDecl value;
  value.is_number = node.kind == JsonKind::Number;
  value.number = node.number;
  value.text = node.text;
  value.span = inner_span(node);
  value.has_exact_offsets = !node.has_escapes;
  return value;
}

std::optional<NameDecl> ObjectReader::name(std::string_view key) {
  const JsonId id = child(key);
  return id == JsonId::None ? std::nullopt : name_of(id, key);
}

std::optional<ValueDecl> ObjectReader::value(std::string_view key) {
  const JsonId id = child(key);
  return id == JsonId::None ? std::nullopt : value_of(id, key);
}

std::vector<NameDecl> ObjectReader::names(std::string_view key) {
  std::vector<NameDecl> result;
  const JsonId id = child(key);
  if (id == JsonId::None) {
    return result;
  }
  if (tree_[id].kind != JsonKind::Array) {
    if (tree_[id].kind != JsonKind::String) {
      report_type(id, key, "a string or a list of strings");
    } else {
      result.push_back(*name_of(id, key));
    }
    return result;
  }
  if (tree_[id].child_count == 0) {
    diagnostics_.add(Code::EmptyList, tree_[id].span, {fmt::format("`{}`", key)});
  }
  for (JsonId item = tree_[id].first_child; item != JsonId::None; item = tree_[item].next_sibling) {
    if (auto decl = name_of(item, key)) {
      result.push_back(std::move(*decl));
    }
  }
  return result;
}

std::vector<ValueDecl> ObjectReader::values(std::string_view key, std::size_t count) {
  std::vector<ValueDecl> result;
  const JsonId id = child(key);
  if (id == JsonId::None) {
    return result;
  }
  if (tree_[id].kind != JsonKind::Array) {
    report_type(id, key, count == 0 ? "a list" : fmt::format("a list of {}", count));
    return result;
  }
  if (count != 0 && tree_[id].child_count != count) {
    diagnostics_.add(Code::WrongCount, tree_[id].span,
                     {fmt::format("`{}`", key), fmt::format("{}", tree_[id].child_count), fmt::format("{}", count)});
    return result;
  }
  for (JsonId item = tree_[id].first_child; item != JsonId::None; item = tree_[item].next_sibling) {
    if (auto decl = value_of(item, key)) {
      result.push_back(std::move(*decl));
    }
  }
  if (count != 0 && result.size() != count) {
    result.clear();
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
  if (!has(key)) {
    report_missing(key);
  }
  return decl.value_or(NameDecl{});
}

ValueDecl ObjectReader::required_value(std::string_view key) {
  auto decl = value(key);
  if (!has(key)) {
    report_missing(key);
  }
  return decl.value_or(ValueDecl{});
}

std::vector<NameDecl> ObjectReader::required_names(std::string_view key) {
  auto decl = names(key);
  if (!has(key)) {
    report_missing(key);
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
    known_.push_back(node.key);
    KeyedValue keyed;
    keyed.key = {node.key, key_inner_span(node)};
    keyed.span = inner_span(node);
    keyed.is_list = node.kind == JsonKind::Array;
    if (keyed.is_list) {
      for (JsonId item = node.first_child; item != JsonId::None; item = tree_[item].next_sibling) {
        if (auto decl = value_of(item, node.key)) {
          keyed.values.push_back(std::move(*decl));
        }
      }
    } else if (node.kind == JsonKind::Boolean) {
      keyed.values.push_back({false, 0, node.boolean ? "true" : "false", node.span, true});
    } else if (auto decl = value_of(id, node.key)) {
      keyed.values.push_back(std::move(*decl));
    } else {
      continue;
    }
    result.push_back(std::move(keyed));
  }
  return result;
}

void ObjectReader::finish() {
  if (!is_object_) {
    return;
  }
  for (JsonId id = tree_[object_].first_child; id != JsonId::None; id = tree_[id].next_sibling) {
    const JsonNode& node = tree_[id];
    if (std::find(known_.begin(), known_.end(), node.key) == known_.end()) {
      diagnostics_.add(Code::UnknownKey, key_inner_span(node), {node.key, what_})
          .help_if(nearest_name(node.key, known_), "did you mean `{}`?");
    }
  }
  for (const std::string& key : missing_) {
    const Span span = tree_[object_].key_span.end > 0
                          ? key_inner_span(tree_[object_])
                          : Span{tree_[object_].span.file, tree_[object_].span.begin, tree_[object_].span.begin + 1};
    diagnostics_.add(Code::MissingKey, span, {what_, key});
  }
}

}  // namespace tectum
