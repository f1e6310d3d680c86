// Inputs, outputs and joints.
#include <utility>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

std::vector<RingDecl> parse_rings(const SectionContext& context, JsonId id) {
  std::vector<RingDecl> rings;
  const JsonNode& list = context.tree[id];
  if (list.kind != JsonKind::Array) {
    context.diagnostics.add(Code::WrongType, list.span,
                            {"`rings`", std::string(kind_phrase(list.kind)), "a list of rings"});
    return rings;
  }
  if (list.child_count == 0) {
    context.diagnostics.add(Code::EmptyList, list.span, {"`rings`"});
  }
  for (JsonId child = list.first_child; child != JsonId::None; child = context.tree[child].next_sibling) {
    ObjectReader reader(context.tree, child, "a ring", context.diagnostics);
    RingDecl ring;
    ring.span = reader.span();
    ring.outer = reader.required_value("outer");
    ring.fields_per_side = reader.value("fields_per_side");
    ring.block = reader.values("block", 2);
    if (reader.has("fields_per_side") && reader.has("block")) {
      context.diagnostics.add(Code::KeysExclude, ring.span, {"fields_per_side", "block"});
      ring.outer.is_poisoned = true;
    } else if (!reader.has("fields_per_side") && !reader.has("block")) {
      reader.report_missing("fields_per_side");
      ring.fields_per_side = ValueDecl{};
      ring.fields_per_side->is_poisoned = true;
    }
    reader.finish();
    rings.push_back(std::move(ring));
  }
  return rings;
}

FoveatedDecl parse_foveated(const SectionContext& context, JsonId id) {
  ObjectReader reader(context.tree, id, "`foveated`", context.diagnostics);
  FoveatedDecl decl;
  decl.span = context.tree[id].span;
  decl.outer = reader.required_value("outer");
  decl.inner = reader.required_value("inner");
  decl.fields_per_side = reader.required_value("fields_per_side");
  decl.fovea_px = reader.required_value("fovea_px");
  reader.finish();
  return decl;
}

}  // namespace

RetinaDecl parse_input(const SectionContext& context, const Member& member) {
  RetinaDecl decl;
  decl.name = member.name;
  decl.span = context.tree[member.id].span;
  ObjectReader outer(context.tree, member.id, described("input", member.name), context.diagnostics);
  const JsonId id = outer.child("retina");
  if (id == JsonId::None) {
    decl.is_poisoned = true;
    decl.eye.is_poisoned = true;
    decl.field_of_view.is_poisoned = true;
    outer.report_missing("retina");
    outer.finish();
    return decl;
  }
  static_cast<void>(outer.provenance());
  outer.finish();
  ObjectReader reader(context.tree, id, described("retina", member.name), context.diagnostics);
  decl.eye = reader.required_name("eye");
  decl.frame = reader.values("frame", 2);
  if (const JsonId frame = reader.child("frame"); frame != JsonId::None) {
    decl.frame_span = context.tree[frame].span;
  } else {
    reader.report_missing("frame");
  }
  decl.field_of_view = reader.required_value("field_of_view");
  if (const JsonId rings = reader.child("rings"); rings != JsonId::None) {
    decl.rings = parse_rings(context, rings);
  }
  if (const JsonId foveated = reader.child("foveated"); foveated != JsonId::None) {
    decl.foveated = parse_foveated(context, foveated);
  }
  if (reader.has("rings") && reader.has("foveated")) {
    context.diagnostics.add(Code::KeysExclude, decl.name.span, {"rings", "foveated"});
  } else if (!reader.has("rings") && !reader.has("foveated")) {
    reader.report_missing("rings");
  }
  decl.is_poisoned = decl.frame.empty() || (decl.rings.empty() && !decl.foveated);
  if (const JsonId lit = reader.child("lit"); lit != JsonId::None) {
    ObjectReader lit_reader(context.tree, lit, "`lit`", context.diagnostics);
    decl.lit_channel = lit_reader.required_name("channel");
    decl.lit_above = lit_reader.required_value("above");
    lit_reader.finish();
  } else {
    reader.report_missing("lit");
  }
  decl.fires_when = reader.name("fires_when");
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

OutputDecl parse_output(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("output", member.name), context.diagnostics);
  OutputDecl decl;
  decl.name = member.name;
  decl.rate_difference = reader.names("rate_difference");
  decl.gain = reader.value("gain");
  if (const JsonId id = reader.child("terms"); id != JsonId::None) {
    const JsonNode& list = context.tree[id];
    if (list.kind != JsonKind::Array) {
      context.diagnostics.add(Code::WrongType, list.span,
                              {"`terms`", std::string(kind_phrase(list.kind)), "a list of terms"});
    }
    if (list.kind == JsonKind::Array && list.child_count == 0) {
      context.diagnostics.add(Code::EmptyList, list.span, {"`terms`"});
    }
    for (JsonId child = list.kind == JsonKind::Array ? list.first_child : JsonId::None; child != JsonId::None;
         child = context.tree[child].next_sibling) {
      ObjectReader term(context.tree, child, "a term", context.diagnostics);
      decl.terms.push_back({term.required_name("population"), term.required_value("gain")});
      term.finish();
    }
  }
  if (reader.has("rate_difference") && reader.has("terms")) {
    context.diagnostics.add(Code::KeysExclude, member.name.span, {"rate_difference", "terms"});
  } else if (!reader.has("rate_difference") && !reader.has("terms")) {
    reader.report_missing("rate_difference");
  } else if (reader.has("rate_difference") && !reader.has("gain")) {
    reader.report_missing("gain");
  }
  decl.window = reader.required_value("window");
  decl.offset = reader.value("offset");
  decl.joints = reader.required_names("joints");
  decl.limits = reader.values("limits", 2);
  decl.provenance = reader.provenance();
  reader.finish();
  return decl;
}

JointDecl parse_joint(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("joint", member.name), context.diagnostics);
  JointDecl decl;
  decl.name = member.name;
  decl.limits = reader.values("limits", 2);
  if (const JsonId limits = reader.child("limits"); limits != JsonId::None) {
    decl.limits_span = context.tree[limits].span;
  }
  decl.max_speed = reader.value("max_speed");
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

}  // namespace tectum
