// Neuron models that the circuit declares by their equations.
#include <utility>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

/// An object of name: expression.
std::vector<NamedValueDecl> named_values(const SectionContext& context, ObjectReader& owner, const char* key) {
  std::vector<NamedValueDecl> result;
  const JsonId id = owner.child(key);
  if (id == JsonId::None) {
    return result;
  }
  ObjectReader reader(context.tree, id, quoted_key(key), context.diagnostics);
  if (!reader.is_object()) {
    result.emplace_back().value.is_poisoned = true;
  }
  for (KeyedValue& keyed : reader.rest()) {
    NamedValueDecl& made = result.emplace_back();
    made.name = keyed.key;
    if (keyed.values.size() == 1 && !keyed.is_list) {
      made.value = std::move(keyed.values.front());
    } else {
      context.diagnostics.add(Code::WrongType, keyed.span, {quoted_key(keyed.key.text), "a list", "an expression"});
      made.value.is_poisoned = true;
    }
  }
  return result;
}

}  // namespace

ModelDecl parse_model(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("model", member.name), context.diagnostics);
  ModelDecl decl;
  decl.name = member.name;
  decl.parameters = named_values(context, reader, "parameters");
  decl.inputs = named_values(context, reader, "inputs");
  decl.states = named_values(context, reader, "states");
  decl.equations = named_values(context, reader, "equations");
  decl.threshold = reader.required_value("threshold");
  decl.reset = named_values(context, reader, "reset");
  decl.refractory = reader.value("refractory");
  if (reader.has("hold")) {
    decl.hold = reader.names("hold");
  }
  decl.method = reader.name("method");
  for (const char* key : {"states", "equations"}) {
    if (!reader.has(key)) {
      reader.report_missing(key);
      decl.threshold.is_poisoned = true;
    }
  }
  decl.provenance = reader.provenance();
  reader.finish();
  return decl;
}

}  // namespace tectum
