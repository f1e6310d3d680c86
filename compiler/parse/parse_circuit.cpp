#include "compiler/parse/parse_circuit.h"

#include <fmt/format.h>

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
    reader.report_missing("tectum");
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

}  // namespace

std::optional<CircuitDecl> parse_circuit(const JsonTree& tree, const Sources& sources, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const SectionContext context{tree, sources, diagnostics};
  ObjectReader reader(tree, tree.root(), "the circuit", diagnostics);
  if (!reader.is_object()) {
    return std::nullopt;
  }
  CircuitDecl decl;
  decl.span = reader.span();
  static_cast<void>(reader.name("$schema"));
  check_language_version(context, reader);
  decl.name = reader.required_name("name");
  static_cast<void>(reader.text("about"));
  decl.tick = reader.value("tick");
  decl.seed = reader.value("seed");
  decl.references = parse_section(context, reader, "references", parse_reference);
  decl.parameters = parse_section(context, reader, "parameters", parse_parameter);
  decl.axes = parse_section(context, reader, "axes", parse_axis);
  decl.neurons = parse_section(context, reader, "neurons", parse_neuron);
  decl.populations = parse_section(context, reader, "populations", parse_population);
  decl.projections = parse_section(context, reader, "projections", parse_projection);
  decl.retinas = parse_section(context, reader, "inputs", parse_input);
  decl.outputs = parse_section(context, reader, "outputs", parse_output);
  decl.joints = parse_section(context, reader, "joints", parse_joint);
  decl.lesions = parse_section(context, reader, "lesions", parse_lesion);
  decl.modules = parse_section(context, reader, "modules", parse_module);
  decl.instances = parse_section(context, reader, "instances", parse_instance);
  reader.finish();
  if (diagnostics.error_count() > errors_before) {
    return std::nullopt;
  }
  expand_modules(decl, diagnostics);
  if (diagnostics.error_count() > errors_before) {
    return std::nullopt;
  }
  return decl;
}

}  // namespace tectum
