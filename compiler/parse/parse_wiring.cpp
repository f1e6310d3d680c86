// Projections and lesions.
#include <string>
#include <utility>

#include "compiler/parse/compose.h"
#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

/// "all_to_all", or {"fixed_probability": {"p": 0.1}}, or {"kind": "fixed_probability", "p": 0.1}.
RuleDecl parse_rule(const SectionContext& context, ObjectReader& projection) {
  RuleDecl rule;
  const JsonId id = projection.child("rule");
  if (id == JsonId::None) {
    projection.report_missing("rule");
    rule.kind.is_poisoned = true;
    return rule;
  }
  const JsonNode& node = context.tree[id];
  if (node.kind == JsonKind::String) {
    rule.kind = {node.text, inner_span(node)};
    return rule;
  }
  ObjectReader reader(context.tree, id, "`rule`", context.diagnostics);
  rule.kind = reader.required_name("kind");
  if (rule.kind.text == "edges") {
    rule.file = reader.required_name("file");
    if (rule.file->is_poisoned) {
      rule.kind.is_poisoned = true;
      return rule;
    }
    rule.path = resolve_path(context.sources.file(rule.file->span.file).name, rule.file->text);
    if (const JsonId columns = reader.child("columns"); columns != JsonId::None) {
      ObjectReader column_reader(context.tree, columns, "`columns`", context.diagnostics);
      rule.columns = column_reader.rest();
    }
    rule.separator = reader.name("separator");
    rule.rows = parse_row_filter(context, reader, "rows");
  }
  rule.arguments = reader.rest();
  reader.finish();
  return rule;
}

/// "contra", or {"horizontal": "contra", "eye": "ipsi"}.
std::vector<SideDecl> parse_side(const SectionContext& context, ObjectReader& projection) {
  std::vector<SideDecl> sides;
  const JsonId id = projection.child("side");
  if (id == JsonId::None) {
    return sides;
  }
  const JsonNode& node = context.tree[id];
  if (node.kind == JsonKind::String) {
    sides.push_back({{}, {node.text, inner_span(node)}});
    return sides;
  }
  ObjectReader reader(context.tree, id, "`side`", context.diagnostics);
  for (KeyedValue& entry : reader.rest()) {
    if (entry.values.size() == 1 && entry.values.front().is_poisoned) {
      continue;
    }
    if (entry.values.size() == 1 && !entry.values.front().is_number) {
      sides.push_back({entry.key, {entry.values.front().text, entry.values.front().span}});
    } else {
      context.diagnostics.add(Code::WrongType, entry.span, {"a side", "something else", "a string"});
    }
  }
  return sides;
}

}  // namespace

std::vector<ExceptionDecl> parse_exceptions(const SectionContext& context, ObjectReader& owner) {
  std::vector<ExceptionDecl> exceptions;
  const JsonId id = owner.child("exceptions");
  if (id == JsonId::None) {
    return exceptions;
  }
  const JsonNode& list = context.tree[id];
  if (list.kind != JsonKind::Object) {
    context.diagnostics.add(Code::WrongType, list.span,
                            {"`exceptions`", std::string(kind_phrase(list.kind)), "an object of side: what differs"});
    return exceptions;
  }
  for (JsonId child = list.first_child; child != JsonId::None; child = context.tree[child].next_sibling) {
    const JsonNode& node = context.tree[child];
    ExceptionDecl decl;
    decl.side = {node.key, {node.key_span.file, node.key_span.begin + 1, node.key_span.end - 1}};
    ObjectReader reader(context.tree, child, described("exception", decl.side), context.diagnostics);
    static_cast<void>(reader.provenance());
    decl.values = reader.rest();
    exceptions.push_back(std::move(decl));
  }
  return exceptions;
}

ProjectionDecl parse_projection(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("projection", member.name), context.diagnostics);
  ProjectionDecl decl;
  decl.name = member.name;
  decl.from = reader.required_names("from");
  decl.to = reader.required_names("to");
  decl.rule = parse_rule(context, reader);
  decl.side = parse_side(context, reader);
  decl.only_sides = reader.names("sides");
  decl.sign = reader.name("sign");
  decl.receptor = reader.name("receptor");
  decl.weight = reader.required_value("weight");
  decl.delay = reader.required_value("delay");
  decl.where = reader.value("where");
  decl.exceptions = parse_exceptions(context, reader);
  if (const JsonId id = reader.child("plasticity"); id != JsonId::None) {
    decl.plasticity = parse_plasticity(context, id, reader.what());
  }
  decl.provenance = reader.provenance();
  reader.finish();
  return decl;
}

LesionDecl parse_lesion(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("lesion", member.name), context.diagnostics);
  LesionDecl decl;
  decl.name = member.name;
  if (reader.has("weaken")) {
    decl.targets = reader.required_names("weaken");
    decl.weaken_to = reader.required_value("to");
  } else {
    decl.targets = reader.required_names("remove");
  }
  decl.fraction = reader.value("fraction");
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

StimulusDecl parse_stimulus(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("stimulus", member.name), context.diagnostics);
  StimulusDecl decl;
  decl.name = member.name;
  decl.into = reader.required_names("into");
  decl.receptor = reader.name("receptor");
  decl.amplitude = reader.required_value("amplitude");
  decl.at = reader.required_value("at");
  decl.duration = reader.required_value("duration");
  decl.pulses = reader.value("pulses");
  decl.every = decl.pulses ? std::optional(reader.required_value("every")) : reader.value("every");
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

}  // namespace tectum
