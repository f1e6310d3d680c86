// Which servo turns which joint, and how its units become degrees.
//
//   degrees from home = direction * (x * deg_per_unit + sum over k of bend_deg[k] * (x / 100)^(k + 2)),
//                   x = units - home_units
// The bend is what a calibration finds beyond a straight line; all zero without one. A map has to rise, or fall, all
// the way from min_units to max_units (is_monotonic).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "drivers/servo/ax12_registers.h"
#include "runtime/image/spike_image.h"

namespace tectum {

struct ServoJoint {
  bool is_present = true;
  std::uint8_t id = 0;
  int direction = 1;  // +1: counter-clockwise is right, or up; -1: the other way round
  double home_units = 512;
  double deg_per_unit = ax12::kUnitDeg;
  std::array<double, 3> bend_deg{};
  std::uint16_t min_units = 0;  // nothing outside [min, max] is ever sent
  std::uint16_t max_units = ax12::kHighestPosition;
  double max_speed_deg_s = 0;  // 0 = as fast as it can
  std::uint16_t torque_limit = 1023;
};

struct ServoMap {
  /// The head of 2020: IDs 1 and 2 are the neck, 3 and 4 the left eye, 5 and 6 the right one, pan before tilt. Which
  /// way round each is mounted is not published: a head file says.
  std::array<ServoJoint, kJointCount> joints = {{{.id = 3}, {.id = 4}, {.id = 5}, {.id = 6}, {.id = 1}, {.id = 2}}};
};

[[nodiscard]] inline double deg_of(const ServoJoint& joint, double units) noexcept {
  const double x = units - joint.home_units;
  const double hundreds = x / 100;
  double bend_deg = 0;
  for (std::size_t k = joint.bend_deg.size(); k-- > 0;) {
    bend_deg = (bend_deg + joint.bend_deg[k]) * hundreds;
  }
  return joint.direction * (x * joint.deg_per_unit + bend_deg * hundreds);
}

[[nodiscard]] inline bool is_monotonic(const ServoJoint& joint) noexcept {
  for (int units = joint.min_units; units < joint.max_units; ++units) {
    if ((deg_of(joint, units + 1) - deg_of(joint, units)) * joint.direction * joint.deg_per_unit <= 0) {
      return false;
    }
  }
  return true;
}

/// Nothing for an angle that is no number. Rounded, and cut to [min_units, max_units].
[[nodiscard]] inline std::optional<std::uint16_t> units_of(const ServoJoint& joint, double deg) noexcept {
  const bool is_bent = joint.bend_deg != decltype(joint.bend_deg){};
  if (!is_bent) {
    const double units = joint.home_units + joint.direction * deg / joint.deg_per_unit;
    if (!std::isfinite(units)) {
      return std::nullopt;
    }
    return static_cast<std::uint16_t>(std::lround(std::clamp<double>(units, joint.min_units, joint.max_units)));
  }
  if (!std::isfinite(deg)) {
    return std::nullopt;
  }
  // The first whole unit at or beyond `deg`, by halving; then the nearer of it and the one before.
  const double way = joint.direction * joint.deg_per_unit > 0 ? 1 : -1;
  int low = joint.min_units, high = joint.max_units;
  while (low < high) {
    const int middle = (low + high) / 2;
    if ((deg_of(joint, middle) - deg) * way < 0) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const bool is_before_nearer =
      low > joint.min_units && std::abs(deg_of(joint, low - 1) - deg) < std::abs(deg_of(joint, low) - deg);
  return static_cast<std::uint16_t>(is_before_nearer ? low - 1 : low);
}

}  // namespace tectum
