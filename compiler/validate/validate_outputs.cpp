// Outputs and joints: from firing rates to angles.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "compiler/diagnostics/counted.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

/// deg/s/Hz: an angle in the coherent system, because the seconds cancel the hertz.
constexpr Dimension kVelocityGain = kAngle;
constexpr Dimension kPositionGain = kAnglePerFrequency;

std::optional<Joint> find_joint(std::string_view name) {
  for (std::uint32_t j = 0; j < kJointCount; ++j) {
    if (name == kJointNames[j]) {
      return static_cast<Joint>(j);
    }
  }
  return std::nullopt;
}

std::optional<Joint> joint(Validation& v, const NameDecl& name) {
  const auto found = find_joint(name.text);
  if (!found && !name.is_poisoned) {
    const std::vector<std::string> names(kJointNames.begin(), kJointNames.end());
    v.diagnostics()
        .add(Code::UnknownJoint, name.span, {name.text})
        .help_if(nearest_name(name.text, names), "did you mean `{}`?");
  }
  return found;
}

struct Limits {
  double min_deg = 0;
  double max_deg = 0;
  Span span;
};

std::optional<Limits> limits(Validation& v, const std::vector<ValueDecl>& values) {
  if (values.size() != 2) {
    return std::nullopt;
  }
  const auto lowest = v.scope.constant(values[0], "limits", kAngle);
  const auto highest = v.scope.constant(values[1], "limits", kAngle);
  if (!lowest || !highest) {
    return std::nullopt;
  }
  const Span span{values[0].span.file, values[0].span.begin, values[1].span.end};
  if (*lowest > *highest) {
    v.diagnostics().add(Code::RangeReversed, span, {"`limits`", shown(*lowest, kAngle), shown(*highest, kAngle)});
    return std::nullopt;
  }
  constexpr double kFullTurn = 180;
  if (*lowest < -kFullTurn || *highest > kFullTurn) {
    v.diagnostics().add(
        Code::OutOfRange, span,
        {"limits", fmt::format("{} to {}", shown(*lowest, kAngle), shown(*highest, kAngle)), "-180 deg to 180 deg"});
    return std::nullopt;
  }
  return Limits{*lowest, *highest, span};
}

/// The gain, and whether it makes a position or a velocity.
std::optional<double> gain(Validation& v, const ValueDecl& value, std::optional<OutputKind>& kind, Span& kind_span) {
  const auto quantity = v.scope.quantity(value);
  if (!quantity) {
    return std::nullopt;
  }
  OutputKind found = OutputKind::Position;
  double gain_value = 0;
  if (quantity->dimension == kPositionGain) {
    gain_value = quantity->value / in_hz(1.0);
  } else if (quantity->dimension == kVelocityGain) {
    found = OutputKind::Velocity;
    gain_value = quantity->value;
  } else {
    v.diagnostics().add(Code::WrongDimension, value.span,
                        {"gain", "deg/Hz (position) or deg/s/Hz (velocity)", describe(quantity->dimension)});
    return std::nullopt;
  }
  if (kind && *kind != found) {
    v.diagnostics()
        .add(Code::DimensionMismatch, value.span, {"one output mixes gains of position and of velocity"})
        .label(kind_span, "the other kind");
    return std::nullopt;
  }
  kind = found;
  kind_span = value.span;
  return gain_value;
}

/// Every neuron of the named side, or of all sides.
void add_term(Validation& v, const NameDecl& name, double gain_value, Output& output) {
  const auto endpoint = v.endpoint(name);
  if (!endpoint || !v.is_sound[index_of(endpoint->population)]) {
    return;
  }
  const Population& population = v.circuit.populations[index_of(endpoint->population)];
  for (std::uint32_t i = 0; i < population.instance_count; ++i) {
    const auto id = static_cast<InstanceId>(index_of(population.first_instance) + i);
    const Instance& instance = v.circuit.instances[index_of(id)];
    bool matches = true;
    for (std::size_t a = 0; a < instance.sides.size(); ++a) {
      matches = matches && (!endpoint->fixed_sides[a] || *endpoint->fixed_sides[a] == instance.sides[a]);
    }
    if (matches) {
      output.terms.push_back({id, gain_value});
    }
  }
}

void validate_output(Validation& v, const OutputDecl& decl, Output& output) {
  output.name = decl.name.text;
  v.check_cites(decl.provenance);
  std::optional<OutputKind> kind;
  Span kind_span;
  if (!decl.rate_difference.empty()) {
    if (decl.rate_difference.size() != 2) {
      v.diagnostics().add(Code::WrongCount, decl.rate_difference.front().span,
                          {"`rate_difference`", counted(decl.rate_difference.size(), "value"), "2"});
    }
    const auto value = decl.gain ? gain(v, *decl.gain, kind, kind_span) : std::nullopt;
    for (std::size_t i = 0; i < decl.rate_difference.size(); ++i) {
      add_term(v, decl.rate_difference[i], value.value_or(0) * (i == 0 ? 1 : -1), output);
    }
  }
  for (const OutputTermDecl& term : decl.terms) {
    add_term(v, term.population, gain(v, term.gain, kind, kind_span).value_or(0), output);
  }
  output.kind = kind.value_or(OutputKind::Position);
  constexpr std::uint64_t kMaxRateWindowTicks = kMaxWindowTicks;
  if (const auto ticks = v.scope.ticks(decl.window, "window", v.circuit.tick_ns)) {
    if (*ticks < 1 || *ticks > kMaxRateWindowTicks) {
      v.diagnostics().add(
          Code::OutOfRange, decl.window.span,
          {"window", fmt::format("{} ticks", *ticks), fmt::format("1 to {} ticks", kMaxRateWindowTicks)});
    }
    output.window_ticks = static_cast<std::uint32_t>(*ticks);
  }
  if (decl.offset) {
    output.offset_deg = v.scope.constant(*decl.offset, "offset", kAngle).value_or(0);
  }
  for (const NameDecl& name : decl.joints) {
    if (const auto id = joint(v, name)) {
      output.joint_mask |= 1U << static_cast<std::uint32_t>(*id);
    }
  }
}

/// Limits come from `joints`; an output may give them for its joints instead.
class JointTable {
 public:
  explicit JointTable(Validation& v) : v_(v) {}

  void add_declared(const JointDecl& decl) {
    const auto id = joint(v_, decl.name);
    const auto range = limits(v_, decl.limits);
    double max_speed_deg_s = 0;
    if (decl.max_speed) {
      constexpr double kMsPerSecond = 1000;
      max_speed_deg_s = v_.scope.constant(*decl.max_speed, "max_speed", kAngularVelocity).value_or(0) * kMsPerSecond;
      if (max_speed_deg_s < 0) {
        v_.diagnostics().add(Code::OutOfRange, decl.max_speed->span,
                             {"max_speed", decl.max_speed->text, "0 deg/s or more"});
      }
    }
    if (id) {
      Entry& entry = entries_[static_cast<std::size_t>(*id)];
      entry.max_speed_deg_s = max_speed_deg_s;
      entry.is_used = true;
      entry.limits = range;
      entry.has_wrong_limits = !decl.limits.empty() && !range;
    }
  }

  void add_from_output(const OutputDecl& decl) {
    const auto range = limits(v_, decl.limits);
    for (const NameDecl& name : decl.joints) {
      const auto id = find_joint(name.text);
      if (!id) {
        continue;
      }
      Entry& entry = entries_[static_cast<std::size_t>(*id)];
      if (!entry.is_used) {
        entry.first_use = name;
      }
      entry.is_used = true;
      entry.has_wrong_limits = entry.has_wrong_limits || (!decl.limits.empty() && !range);
      if (range && entry.limits) {
        v_.diagnostics()
            .add(Code::JointDrivenTwice, range->span, {name.text})
            .label(entry.limits->span, "limited here too");
      } else if (range) {
        entry.limits = range;
      }
    }
  }

  void finish() {
    for (std::uint32_t j = 0; j < kJointCount; ++j) {
      const Entry& entry = entries_[j];
      if (entry.is_used && !entry.limits && !entry.has_wrong_limits && entry.first_use) {
        v_.diagnostics()
            .add(Code::JointWithoutLimits, entry.first_use->span, {kJointNames[j]})
            .help(fmt::format("\"joints\": {{ \"{}\": {{ \"limits\": [\"-30 deg\", \"30 deg\"] }} }}", kJointNames[j]));
      }
      if (entry.limits) {
        v_.circuit.joints.push_back(
            {static_cast<Joint>(j), entry.limits->min_deg, entry.limits->max_deg, entry.max_speed_deg_s});
      }
    }
  }

 private:
  struct Entry {
    bool is_used = false;
    bool has_wrong_limits = false;
    std::optional<NameDecl> first_use;
    std::optional<Limits> limits;
    double max_speed_deg_s = 0;
  };

  Validation& v_;
  std::array<Entry, kJointCount> entries_;
};

}  // namespace

void validate_outputs(Validation& v) {
  for (const OutputDecl& decl : v.decl.outputs) {
    validate_output(v, decl, v.circuit.outputs.emplace_back());
  }
  JointTable joints(v);
  for (const JointDecl& decl : v.decl.joints) {
    joints.add_declared(decl);
  }
  for (const OutputDecl& decl : v.decl.outputs) {
    joints.add_from_output(decl);
  }
  joints.finish();
}

}  // namespace tectum
