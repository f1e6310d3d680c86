#include "compiler/parse/parse_circuit.h"

#include <fmt/format.h>

#include <cctype>
#include <string>
#include <utility>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {
namespace {

/// Names are what expressions, side suffixes ("EBN.left") and patterns ("EBN*") can speak of.
bool is_identifier(std::string_view text) {
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) != 0) {
    return false;
  }
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') {
      return false;
    }
  }
  return true;
}

template <typename Decl>
std::vector<Decl> parse_section(const SectionContext& context, ObjectReader& circuit, std::string_view key,
                                Decl (*parse)(const SectionContext&, const Member&)) {
  std::vector<Decl> decls;
  const JsonId id = circuit.child(key);
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

void check_language_version(const SectionContext& context, ObjectReader& reader) {
  const JsonId id = reader.child("tectum");
  if (id == JsonId::None) {
    reader.report_missing("tectum");
    return;
  }
  const JsonNode& node = context.tree[id];
  if (node.kind != JsonKind::Number || node.number != kLanguageVersion) {
    const std::string shown = node.kind == JsonKind::Number ? node.text : std::string(kind_phrase(node.kind));
    context.diagnostics.add(Code::LanguageVersion, node.span, {shown})
        .help(fmt::format("write `\"tectum\": {}`", kLanguageVersion));
  }
}

}  // namespace

std::optional<CircuitDecl> parse_circuit(const JsonTree& tree, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const SectionContext context{tree, diagnostics};
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
  reader.finish();
  if (diagnostics.error_count() > errors_before) {
    return std::nullopt;
  }
  return decl;
}

}  // namespace tectum
