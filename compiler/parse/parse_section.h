// A section of named declarations: "populations": { "EBN": {...}, ... }.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {

/// Names are what expressions, side suffixes ("EBN.left") and patterns ("EBN*") can speak of.
[[nodiscard]] bool is_identifier(std::string_view text);

/// The section that was probably meant by `key`, so that what it holds counts; its name is reported elsewhere.
[[nodiscard]] JsonId find_misspelt_section(const JsonTree& tree, JsonId object, std::string_view key);

/// Is this the name of a section of a circuit?
[[nodiscard]] bool is_section(std::string_view key);

/// `parse` for each member, in the order of the text.
template <typename Decl>
std::vector<Decl> parse_section(const SectionContext& context, ObjectReader& circuit, std::string_view key,
                                Decl (*parse)(const SectionContext&, const Member&)) {
  std::vector<Decl> decls;
  JsonId id = circuit.child(key);
  if (id == JsonId::None) {
    id = find_misspelt_section(context.tree, circuit.id(), key);
  }
  if (id == JsonId::None) {
    return decls;
  }
  const JsonNode& section = context.tree[id];
  if (section.kind != JsonKind::Object) {
    context.diagnostics.add(
        Code::WrongType, section.span,
        {fmt::format("`{}`", key), std::string(kind_phrase(section.kind)), "an object of named declarations"});
    return decls;
  }
  decls.reserve(section.child_count);
  for (JsonId child = section.first_child; child != JsonId::None; child = context.tree[child].next_sibling) {
    const JsonNode& node = context.tree[child];
    const NameDecl name{node.key, {node.key_span.file, node.key_span.begin + 1, node.key_span.end - 1}};
    if (!is_identifier(name.text)) {
      context.diagnostics.add(Code::BadName, name.span, {name.text})
          .help("a name is made of letters, digits and `_`, and does not start with a digit");
    }
    decls.push_back(parse(context, {name, child}));
  }
  return decls;
}

}  // namespace tectum
