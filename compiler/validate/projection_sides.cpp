// Sides: which axes the ends share, how the sides are related, and which of them are meant.
#include <algorithm>

#include "compiler/validate/projection_validator.h"

namespace tectum {

std::vector<AxisId> ProjectionValidator::shared_axes() const {
  std::vector<AxisId> shared;
  for (const Endpoint& from : made_.from) {
    for (const Endpoint& to : made_.to) {
      for (const AxisId axis : population(from).axes) {
        const auto& other = population(to).axes;
        if (std::find(other.begin(), other.end(), axis) != other.end() &&
            std::find(shared.begin(), shared.end(), axis) == shared.end()) {
          shared.push_back(axis);
        }
      }
    }
  }
  return shared;
}

void ProjectionValidator::sides() {
  const std::vector<AxisId> shared = shared_axes();
  for (const SideDecl& side : decl_.side) {
    const auto relation = side.relation.is_poisoned ? std::nullopt : find_relation(side.relation);
    if (!relation) {
      continue;
    }
    std::vector<AxisId> axes = shared;
    if (!side.axis.text.empty()) {
      const auto axis = v_.axis_of.find(side.axis.text);
      if (axis == v_.axis_of.end()) {
        if (v_.can_report(side.axis, "axes")) {
          v_.diagnostics()
              .add(Code::UnknownAxis, side.axis.span, {side.axis.text})
              .help_if(nearest_name(side.axis.text, names_of(v_.decl.axes)), "did you mean `{}`?");
        }
        continue;
      }
      const auto id = static_cast<AxisId>(axis->second);
      axes.clear();
      if (std::find(shared.begin(), shared.end(), id) != shared.end()) {
        axes.push_back(id);
      }
    }
    if (axes.empty()) {
      v_.diagnostics().add(Code::NoSharedAxis, side.relation.span, {decl_.from.front().text, decl_.to.front().text});
    }
    for (const AxisId axis : axes) {
      made_.relations.push_back({axis, *relation});
    }
  }
  only_sides();
}

std::optional<Relation> ProjectionValidator::find_relation(const NameDecl& name) {
  if (name.text == "ipsi") {
    return Relation::Ipsi;
  }
  if (name.text == "contra") {
    return Relation::Contra;
  }
  if (name.text == "both") {
    return Relation::Both;
  }
  v_.diagnostics()
      .add(Code::UnknownWord, name.span, {"side relation", name.text})
      .help("a side is `ipsi`, `contra` or `both`");
  return std::nullopt;
}

std::vector<std::string> ProjectionValidator::known_sides() const {
  std::vector<std::string> known;
  for (const std::vector<Endpoint>* ends : {&made_.to, &made_.from}) {
    for (const Endpoint& end : *ends) {
      for (const AxisId axis : population(end).axes) {
        const auto& sides = v_.circuit.axes[index_of(axis)].sides;
        known.insert(known.end(), sides.begin(), sides.end());
      }
    }
  }
  return known;
}

void ProjectionValidator::only_sides() {
  const std::vector<std::string> known = known_sides();
  for (const NameDecl& side : decl_.only_sides) {
    if (side.is_poisoned) {
      continue;
    }
    if (std::find(known.begin(), known.end(), side.text) == known.end()) {
      v_.diagnostics()
          .add(Code::UnknownSide, side.span, {decl_.to.front().text, side.text})
          .help_if(nearest_name(side.text, known), "did you mean `{}`?");
    }
    made_.only_sides.push_back(side.text);
  }
}

}  // namespace tectum
