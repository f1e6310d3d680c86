// Modules and their instances.
#include <utility>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_section.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

std::vector<PortBinding> parse_ports(const SectionContext& context, ObjectReader& owner) {
  std::vector<PortBinding> bindings;
  const JsonId id = owner.child("ports");
  if (id == JsonId::None) {
    return bindings;
  }
  ObjectReader reader(context.tree, id, "`ports`", context.diagnostics);
  if (!reader.is_object()) {
    return bindings;
  }
  for (JsonId child = context.tree[id].first_child; child != JsonId::None; child = context.tree[child].next_sibling) {
    const JsonNode& node = context.tree[child];
    PortBinding binding;
    binding.port = {node.key, {node.key_span.file, node.key_span.begin + 1, node.key_span.end - 1}};
    binding.populations = reader.names(node.key);
    bindings.push_back(std::move(binding));
  }
  return bindings;
}

}  // namespace

ModuleDecl parse_module(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("module", member.name), context.diagnostics);
  ModuleDecl decl;
  decl.name = member.name;
  decl.ports = reader.names("ports");
  decl.is_poisoned = !reader.is_object();
  for (const char* section : {"parameters", "neurons", "populations", "projections"}) {
    const JsonId id = reader.is_object() ? context.tree.find(member.id, section) : JsonId::None;
    decl.is_poisoned = decl.is_poisoned || (id != JsonId::None && context.tree[id].kind != JsonKind::Object);
  }
  decl.parameters = parse_section(context, reader, "parameters", parse_parameter);
  decl.neurons = parse_section(context, reader, "neurons", parse_neuron);
  decl.populations = parse_section(context, reader, "populations", parse_population);
  decl.projections = parse_section(context, reader, "projections", parse_projection);
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

InstanceDecl parse_instance(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("instance", member.name), context.diagnostics);
  InstanceDecl decl;
  decl.name = member.name;
  decl.module = reader.required_name("module");
  if (const JsonId id = reader.child("parameters"); id != JsonId::None) {
    ObjectReader parameters(context.tree, id, "`parameters`", context.diagnostics);
    decl.parameters = parameters.rest();
  }
  decl.ports = parse_ports(context, reader);
  if (const JsonId id = reader.child("ports"); id != JsonId::None) {
    decl.has_poisoned_ports = context.tree[id].kind != JsonKind::Object;
  }
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

}  // namespace tectum
