// Scalings: which projections share one factor, and the leading eigenvalue that it gives them.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/validate/validation.h"

namespace tectum {
namespace {

/// Nothing for a projection whose weight could not be read, which has been reported.
std::optional<Dimension> weight_dimension(const Projection& projection) {
  const bool is_known = projection.weight.constant || projection.weight.slot_count > 0;
  return is_known ? std::optional(projection.weight.dimension) : std::nullopt;
}

void validate_scaling(Validation& v, const ScalingDecl& decl, Scaling& made) {
  made.name = decl.name.text;
  made.span = decl.leading_eigenvalue.span;
  std::optional<Dimension> common;
  const NameDecl* first = nullptr;
  for (const NameDecl& name : decl.projections) {
    const auto& projections = v.circuit.projections;
    const auto found = std::find_if(projections.begin(), projections.end(),
                                    [&](const Projection& projection) { return projection.name == name.text; });
    if (found == projections.end()) {
      if (v.can_report(name, "projections")) {
        v.diagnostics()
            .add(Code::UnknownProjection, name.span, {name.text})
            .help_if(nearest_name(name.text, names_of(v.decl.projections)), "did you mean `{}`?");
      }
      continue;
    }
    const auto dimension = weight_dimension(*found);
    if (dimension && common && *dimension != *common) {
      v.diagnostics()
          .add(Code::DimensionMismatch, name.span,
               {fmt::format("`{}` has weights of another kind than `{}`", name.text, first->text)})
          .help("write one scaling for each kind");
    }
    if (dimension && !common) {
      common = dimension;
      first = &name;
    }
    made.projections.push_back(static_cast<ProjectionId>(found - projections.begin()));
  }
  if (!common) {
    v.scope.keep_silent();
    return;
  }
  const auto wanted = v.scope.constant(decl.leading_eigenvalue, "leading_eigenvalue", *common);
  if (wanted && !(*wanted > 0)) {
    v.diagnostics().add(Code::OutOfRange, decl.leading_eigenvalue.span,
                        {"leading_eigenvalue", shown(*wanted, *common), "more than 0"});
  }
  made.leading_eigenvalue = wanted.value_or(0);
}

}  // namespace

void validate_scalings(Validation& v) {
  for (const ScalingDecl& decl : v.decl.scalings) {
    validate_scaling(v, decl, v.circuit.scalings.emplace_back());
  }
}

}  // namespace tectum
