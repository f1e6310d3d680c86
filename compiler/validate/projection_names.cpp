// What the expressions of a projection may read: indices, places, sides and fields of the two neurons.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/validate/projection_validator.h"

namespace tectum {

bool ProjectionValidator::has_fields(const std::vector<Endpoint>& ends) const {
  return std::all_of(ends.begin(), ends.end(),
                     [&](const Endpoint& e) { return population(e).model == ModelKind::FieldSource; });
}

bool ProjectionValidator::is_spatial(const Axis& axis) {
  return std::all_of(axis.sides.begin(), axis.sides.end(), [](const std::string& side) {
    return side == "left" || side == "right" || side == "up" || side == "down";
  });
}

void ProjectionValidator::make_environment() {
  names_.outer = &v_.scope.environment;
  names_.add_variable("pre.index", kNumber, kPreIndex);
  names_.add_variable("post.index", kNumber, kPostIndex);
  names_.add_variable("pre.size", kNumber, kPreSize);
  names_.add_variable("post.size", kNumber, kPostSize);
  names_.add_variable("pre.pos", kNumber, kPrePosition);
  names_.add_variable("post.pos", kNumber, kPostPosition);
  names_.add_variable("random", kNumber, kPairRandom);
  place_names();
}

std::optional<Dimension> ProjectionValidator::position_dimension(const std::vector<Endpoint>& ends) const {
  std::optional<Dimension> common = population(ends.front()).position_dimension;
  for (const Endpoint& end : ends) {
    common = population(end).position_dimension == common ? common : std::nullopt;
  }
  return common;
}

void ProjectionValidator::place_names() {
  const auto pre = position_dimension(made_.from);
  const auto post = position_dimension(made_.to);
  if (pre) {
    names_.add_variable("pre.x", *pre, kPreX);
    names_.add_variable("pre.y", *pre, kPreY);
    names_.add_variable("x", *pre, kPreX);
    names_.add_variable("y", *pre, kPreY);
  }
  if (post) {
    names_.add_variable("post.x", *post, kPostX);
    names_.add_variable("post.y", *post, kPostY);
  }
  if (pre && pre == post) {
    names_.add_variable("distance", *pre, kDistance);
  }
  const bool pre_has_fields = has_fields(made_.from);
  if (pre_has_fields) {
    names_.add_variable("pre.ecc", kAngle, kPreEccentricity);
    names_.add_variable("ecc", kAngle, kPreEccentricity);
  }
  side_names(pre == kAngle);
  explain_absent_names();
}

void ProjectionValidator::explain_absent_names() {
  const std::string& from = population(made_.from.front()).name;
  const std::string& to = population(made_.to.front()).name;
  v_.scope.absent = {
      {"ecc", fmt::format("`ecc` needs a retina population as the source, `{}` is none", from)},
      {"pre.ecc", fmt::format("`pre.ecc` needs a retina population as the source, `{}` is none", from)},
      {"x", fmt::format("`x` needs a source with positions, `{}` has none", from)},
      {"y", fmt::format("`y` needs a source with positions, `{}` has none", from)},
      {"pre.x", fmt::format("`pre.x` needs a source with positions, `{}` has none", from)},
      {"pre.y", fmt::format("`pre.y` needs a source with positions, `{}` has none", from)},
      {"post.x", fmt::format("`post.x` needs a target with positions, `{}` has none", to)},
      {"post.y", fmt::format("`post.y` needs a target with positions, `{}` has none", to)},
      {"distance", fmt::format("`distance` needs positions of one dimension at both ends, `{}` and `{}`", from, to)},
      {"hemifield", fmt::format("`hemifield` needs a source in the visual field and one axis of left/right or up/down "
                                "on the target, `{}` and `{}`",
                                from, to)},
      {"side", fmt::format("`side` needs one axis on the target or the source, `{}` and `{}`", to, from)},
  };
}

void ProjectionValidator::side_names(bool pre_has_angles) {
  std::vector<AxisId> post_axes = population(made_.to.front()).axes;
  std::vector<AxisId> pre_axes = population(made_.from.front()).axes;
  std::vector<AxisId> spatial;
  for (std::uint32_t a = 0; a < v_.circuit.axes.size(); ++a) {
    const auto id = static_cast<AxisId>(a);
    const Axis& axis = v_.circuit.axes[a];
    const std::uint32_t slot = kFirstAxisVariable + 3 * a;
    const bool pre_has = std::find(pre_axes.begin(), pre_axes.end(), id) != pre_axes.end();
    const bool post_has = std::find(post_axes.begin(), post_axes.end(), id) != post_axes.end();
    if (pre_has) {
      names_.add_variable("pre.side." + axis.name, kWord, slot);
    }
    if (post_has) {
      names_.add_variable("post.side." + axis.name, kWord, slot + 1);
    }
    if (pre_has || post_has) {
      names_.add_variable("side." + axis.name, kWord, slot + (post_has ? 1 : 0));
    }
    if (pre_has_angles && is_spatial(axis)) {
      names_.add_variable("hemifield." + axis.name, kWord, slot + 2);
      if (post_has) {
        spatial.push_back(id);
      }
    }
  }
  // The short names, where only one axis can be meant.
  if (spatial.size() == 1) {
    const std::uint32_t slot = kFirstAxisVariable + 3 * static_cast<std::uint32_t>(spatial.front());
    names_.add_variable("hemifield", kWord, slot + 2);
    names_.add_variable("side", kWord, slot + 1);
  } else if (post_axes.size() == 1) {
    names_.add_variable("side", kWord, kFirstAxisVariable + 3 * static_cast<std::uint32_t>(post_axes.front()) + 1);
  } else if (post_axes.empty() && pre_axes.size() == 1) {
    names_.add_variable("side", kWord, kFirstAxisVariable + 3 * static_cast<std::uint32_t>(pre_axes.front()));
  }
}

}  // namespace tectum
