// Cells that a file lists, the rows of it that are meant, and the scaling of measured weights.
#include <utility>

#include "compiler/parse/compose.h"
#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_sections.h"

namespace tectum {

TableDecl parse_table(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("table", member.name), context.diagnostics);
  TableDecl decl;
  decl.name = member.name;
  decl.file = reader.required_name("file");
  if (!decl.file.is_poisoned) {
    decl.path = resolve_path(context.sources.file(decl.file.span.file).name, decl.file.text);
  }
  decl.ids = reader.required_names("id");
  decl.separator = reader.name("separator");
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

ScalingDecl parse_scaling(const SectionContext& context, const Member& member) {
  ObjectReader reader(context.tree, member.id, described("scaling", member.name), context.diagnostics);
  ScalingDecl decl;
  decl.name = member.name;
  decl.projections = reader.required_names("projections");
  decl.leading_eigenvalue = reader.required_value("leading_eigenvalue");
  static_cast<void>(reader.provenance());
  reader.finish();
  return decl;
}

CellsDecl parse_cells(const SectionContext& context, JsonId id) {
  ObjectReader reader(context.tree, id, quoted_key("cells"), context.diagnostics);
  CellsDecl decl;
  decl.span = context.tree[id].span;
  decl.table = reader.required_name("table");
  decl.where = parse_row_filter(context, reader, "where");
  reader.finish();
  return decl;
}

std::vector<KeyedValue> parse_row_filter(const SectionContext& context, ObjectReader& owner, std::string_view key) {
  const JsonId id = owner.child(key);
  if (id == JsonId::None) {
    return {};
  }
  ObjectReader reader(context.tree, id, quoted_key(key), context.diagnostics);
  return reader.rest();
}

}  // namespace tectum
