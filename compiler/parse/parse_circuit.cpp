#include "compiler/parse/parse_circuit.h"

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>

#include "compiler/parse/expand_modules.h"
#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_section.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

void check_language_version(const SectionContext& context, ObjectReader& reader) {
  const JsonId id = reader.child("tectum");
  if (id == JsonId::None) {
    if (context.tree.is_whole) {
      reader.report_missing("tectum");
    }
    return;
  }
  const JsonNode& node = context.tree[id];
  if (node.kind != JsonKind::Number || node.number != kLanguageVersion) {
    const std::string shown = node.kind == JsonKind::Number   ? node.text
                              : node.kind == JsonKind::String ? "\"" + node.text + "\""
                                                              : std::string(kind_phrase(node.kind));
    context.diagnostics.add(Code::LanguageVersion, node.span, {shown})
        .help(fmt::format("write `\"tectum\": {}`", kLanguageVersion));
  }
}

/// Sections that are no objects, or whose names may stand under a key or in a file that could not be read.
std::set<std::string> poisoned_sections(const JsonTree& tree) {
  std::set<std::string> poisoned;
  bool has_strange_section = !tree.is_whole;
  for (JsonId id = tree[tree.root()].first_child; id != JsonId::None; id = tree[id].next_sibling) {
    const JsonNode& node = tree[id];
    if (is_section(node.key) && node.kind != JsonKind::Object) {
      poisoned.insert(node.key);
    }
    has_strange_section = has_strange_section || (!is_section(node.key) && node.kind == JsonKind::Object);
  }
  for (const char* key :
       {"references", "parameters", "axes", "models", "neurons", "populations", "projections", "inputs", "outputs",
        "joints", "lesions", "stimuli", "modules", "instances", "tables", "scalings"}) {
    const bool is_read =
        tree.find(tree.root(), key) != JsonId::None || find_misspelt_section(tree, tree.root(), key) != JsonId::None;
    if (!tree.is_whole || (has_strange_section && !is_read)) {
      poisoned.insert(key);
    }
  }
  return poisoned;
}

}  // namespace

std::optional<CircuitDecl> parse_circuit(const JsonTree& tree, const Sources& sources, Diagnostics& diagnostics) {
  const SectionContext context{tree, sources, diagnostics};
  ObjectReader reader(tree, tree.root(), "the circuit", diagnostics);
  if (!reader.is_object()) {
    return std::nullopt;
  }
  CircuitDecl decl;
  decl.span = reader.span();
  static_cast<void>(reader.name("$schema"));
  check_language_version(context, reader);
  // What a file that cannot be read would have said, nobody misses.
  decl.name = tree.is_whole ? reader.required_name("name") : reader.name("name").value_or(NameDecl{});
  static_cast<void>(reader.text("about"));
  decl.tick = reader.value("tick");
  decl.seed = reader.value("seed");
  decl.references = parse_section(context, reader, "references", parse_reference);
  decl.parameters = parse_section(context, reader, "parameters", parse_parameter);
  decl.axes = parse_section(context, reader, "axes", parse_axis);
  decl.models = parse_section(context, reader, "models", parse_model);
  decl.neurons = parse_section(context, reader, "neurons", parse_neuron);
  decl.populations = parse_section(context, reader, "populations", parse_population);
  decl.projections = parse_section(context, reader, "projections", parse_projection);
  decl.retinas = parse_section(context, reader, "inputs", parse_input);
  decl.outputs = parse_section(context, reader, "outputs", parse_output);
  decl.joints = parse_section(context, reader, "joints", parse_joint);
  decl.lesions = parse_section(context, reader, "lesions", parse_lesion);
  decl.tables = parse_section(context, reader, "tables", parse_table);
  decl.scalings = parse_section(context, reader, "scalings", parse_scaling);
  decl.stimuli = parse_section(context, reader, "stimuli", parse_stimulus);
  decl.modules = parse_section(context, reader, "modules", parse_module);
  decl.instances = parse_section(context, reader, "instances", parse_instance);
  reader.finish();
  decl.poisoned_sections = poisoned_sections(tree);
  expand_modules(decl, diagnostics);
  return decl;
}

}  // namespace tectum
