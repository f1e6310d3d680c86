// References, parameters, axes, neuron types and populations.
#include <fmt/format.h>

#include <utility>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

std::vector<ReceptorDecl> parse_receptors(const SectionContext& context, JsonId id) {
  std::vector<ReceptorDecl> receptors;
  const JsonNode& list = context.tree[id];
  if (list.kind != JsonKind::Object) {
    context.diagnostics.add(Code::WrongType, list.span,
                            {"`receptors`", std::string(kind_phrase(list.kind)), "an object"});
    return receptors;
  }
  for (JsonId child = list.first_child; child != JsonId::None; child = context.tree[child].next_sibling) {
    const JsonNode& node = context.tree[child];
    ReceptorDecl decl;
    decl.name = {node.key, {node.key_span.file, node.key_span.begin + 1, node.key_span.end - 1}};
    ObjectReader reader(context.tree, child, described("receptor", decl.name), context.diagnostics);
    decl.kind = reader.name("kind");
    decl.tau = reader.value("tau");
    decl.window = reader.value("window");
    reader.finish();
    receptors.push_back(std::move(decl));
  }
  return receptors;
}

/// "left_eye", or {"left": "left_eye", "right": "right_eye"}.
std::vector<InputUseDecl> parse_input_use(const SectionContext& context, ObjectReader& reader) {
  std::vector<InputUseDecl> uses;
  const JsonId id = reader.child("input");
  if (id == JsonId::None) {
    return uses;
  }
  const JsonNode& node = context.tree[id];
  if (node.kind == JsonKind::String) {
    uses.push_back({{}, {node.text, inner_span(node)}});
    return uses;
  }
  if (node.kind != JsonKind::Object) {
    context.diagnostics.add(Code::WrongType, node.span,
                            {"`input`", std::string(kind_phrase(node.kind)), "a string, or an object of side: input"});
    return uses;
  }
  for (JsonId child = node.first_child; child != JsonId::None; child = context.tree[child].next_sibling) {
    const JsonNode& member = context.tree[child];
    if (member.kind != JsonKind::String) {
      context.diagnostics.add(Code::WrongType, member.span,
                              {fmt::format("`{}`", member.key), std::string(kind_phrase(member.kind)), "a string"});
    }
    uses.push_back({{member.key, {member.key_span.file, member.key_span.begin + 1, member.key_span.end - 1}},
                    {member.text, inner_span(member), member.kind != JsonKind::String}});
  }
  return uses;
}

}  // namespace

std::string quoted_key(std::string_view key) { return fmt::format("`{}`", key); }

std::string described(std::string_view kind, const NameDecl& name) { return fmt::format("{} `{}`", kind, name.text); }

ReferenceDecl parse_reference(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("reference", member.name), context.diagnostics);
  ReferenceDecl decl;
  decl.name = member.name;
  decl.doi = reader.text("doi");
  decl.title = reader.text("title");
  for (const char* key : {"authors", "journal", "url", "about", "note"}) {
    static_cast<void>(reader.text(key));
  }
  static_cast<void>(reader.value("year"));
  reader.finish();
  return decl;
}

ParameterDecl parse_parameter(const SectionContext& context, const Member& member) {
  ParameterDecl decl;
  decl.name = member.name;
  const JsonNode& node = context.tree[member.id];
  if (node.kind == JsonKind::String || node.kind == JsonKind::Number) {
    decl.value = {node.kind == JsonKind::Number, node.number, node.text, inner_span(node), !node.has_escapes};
    return decl;
  }
  ObjectReader reader(context.tree, member.id, described("parameter", member.name), context.diagnostics);
  decl.value = reader.required_value("value");
  decl.range = reader.values("range", 2);
  decl.basis = reader.name("basis");
  decl.provenance = reader.provenance();
  reader.finish();
  return decl;
}

AxisDecl parse_axis(const SectionContext& context, const Member& member) {
  AxisDecl decl;
  decl.name = member.name;
  const JsonNode& node = context.tree[member.id];
  if (node.kind != JsonKind::Array || node.child_count < 2) {
    context.diagnostics.add(
        Code::WrongType, node.span,
        {described("axis", member.name),
         node.kind == JsonKind::Array ? "a list of fewer than two sides" : std::string(kind_phrase(node.kind)),
         "a list of sides"});
    return decl;
  }
  for (JsonId child = node.first_child; child != JsonId::None; child = context.tree[child].next_sibling) {
    const JsonNode& side = context.tree[child];
    if (side.kind != JsonKind::String) {
      context.diagnostics.add(Code::WrongType, side.span, {"a side", std::string(kind_phrase(side.kind)), "a string"});
    }
    decl.sides.push_back({side.text, inner_span(side), side.kind != JsonKind::String});
  }
  return decl;
}

NeuronDecl parse_neuron(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("neuron type", member.name), context.diagnostics);
  NeuronDecl decl;
  decl.name = member.name;
  decl.extends = reader.name("extends");
  decl.model = reader.name("model");
  if (reader.is_object() && !decl.model && !decl.extends && !reader.has("model") && !reader.has("extends")) {
    reader.report_missing("model");
  }
  if (const JsonId id = reader.child("receptors"); id != JsonId::None) {
    decl.receptors = parse_receptors(context, id);
    decl.has_poisoned_receptors = context.tree[id].kind != JsonKind::Object;
  }
  decl.provenance = reader.provenance();
  decl.parameters = reader.rest();
  reader.finish();
  return decl;
}

PopulationDecl parse_population(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("population", member.name), context.diagnostics);
  PopulationDecl decl;
  decl.name = member.name;
  decl.neuron = reader.name("neuron");
  decl.inputs = parse_input_use(context, reader);
  decl.size = reader.value("size");
  if (const JsonId id = reader.child("cells"); id != JsonId::None) {
    decl.cells = parse_cells(context, id);
  }
  decl.axes = reader.names("axis");
  decl.nucleus = reader.name("nucleus");
  decl.mixed_signs = reader.text("mixed_signs");
  if (const JsonId id = reader.child("position"); id != JsonId::None) {
    ObjectReader position(context.tree, id, "`position`", context.diagnostics);
    for (KeyedValue& keyed : position.rest()) {
      if (keyed.key.text == "x" || keyed.key.text == "y") {
        decl.position.push_back(std::move(keyed));
      } else {
        context.diagnostics.add(Code::UnknownKey, keyed.key.span, {keyed.key.text, "`position`"});
      }
    }
    for (const char* key : {"x", "y"}) {
      if (!position.has(key)) {
        position.report_missing(key);
        KeyedValue& missing = decl.position.emplace_back();
        missing.key.text = key;
        missing.span = position.span();
        missing.values.emplace_back().is_poisoned = true;
      }
    }
    position.finish();
  }
  decl.exceptions = parse_exceptions(context, reader);
  decl.provenance = reader.provenance();
  decl.overrides = reader.rest();
  if (reader.has("neuron") && reader.has("input")) {
    context.diagnostics.add(Code::KeysExclude, member.name.span, {"neuron", "input"});
    decl.neuron.reset();  // nobody knows which of them is meant
    decl.inputs.clear();
  } else if (!reader.has("neuron") && !reader.has("input")) {
    reader.report_missing("neuron");
  } else if (reader.has("neuron") && !reader.has("size") && !reader.has("cells")) {
    reader.report_missing("size");
  }
  reader.finish();
  return decl;
}

}  // namespace tectum
