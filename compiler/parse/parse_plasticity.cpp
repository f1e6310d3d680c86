// How a projection learns.
#include <string>
#include <utility>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

/// "pan", or { "left": "leftward", "right": "rightward" }.
std::vector<RewardUseDecl> parse_rewards(const SectionContext& context, ObjectReader& plasticity) {
  std::vector<RewardUseDecl> rewards;
  const JsonId id = plasticity.child("reward");
  if (id == JsonId::None) {
    plasticity.report_missing("reward");
    return rewards;
  }
  const JsonNode& node = context.tree[id];
  if (node.kind == JsonKind::String) {
    rewards.push_back({{}, {node.text, inner_span(node)}});
    return rewards;
  }
  ObjectReader reader(context.tree, id, "`reward`", context.diagnostics);
  for (KeyedValue& entry : reader.rest()) {
    const bool is_text = entry.values.size() == 1 && !entry.values.front().is_number;
    if (!is_text) {
      context.diagnostics.add(Code::WrongType, entry.span, {"a reward", "something else", "a string"});
    } else if (!entry.values.front().is_poisoned) {
      rewards.push_back({entry.key, {entry.values.front().text, entry.values.front().span}});
    }
  }
  return rewards;
}

}  // namespace

PlasticityDecl parse_plasticity(const SectionContext& context, JsonId id, const std::string& owner) {
  ObjectReader reader(context.tree, id, "plasticity of " + owner, context.diagnostics);
  PlasticityDecl decl;
  decl.span = reader.span();
  decl.is_poisoned = !reader.is_object();
  if (decl.is_poisoned) {
    return decl;
  }
  decl.rewards = parse_rewards(context, reader);
  decl.form = reader.name("form");
  decl.bounds = reader.values("bounds", 2);
  if (const JsonId bounds = reader.child("bounds"); bounds != JsonId::None) {
    decl.bounds_span = context.tree[bounds].span;
  }
  if (const JsonId learned = reader.child("learned"); learned != JsonId::None) {
    decl.learned = ObjectReader(context.tree, learned, "`learned`", context.diagnostics).rest();
  }
  decl.provenance = reader.provenance();
  decl.numbers = reader.rest();
  reader.finish();
  return decl;
}

}  // namespace tectum
