// Which servo turns which joint, and how its units become degrees.
//
//   degrees from home = direction * (units - home_units) * deg_per_unit
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

/// Nothing for an angle that is no number. Rounded, and cut to [min_units, max_units].
[[nodiscard]] inline std::optional<std::uint16_t> units_of(const ServoJoint& joint, double deg) noexcept {
  const double units = joint.home_units + joint.direction * deg / joint.deg_per_unit;
  if (!std::isfinite(units)) {
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(std::lround(std::clamp<double>(units, joint.min_units, joint.max_units)));
}

[[nodiscard]] inline double deg_of(const ServoJoint& joint, std::uint16_t units) noexcept {
  return joint.direction * (units - joint.home_units) * joint.deg_per_unit;
}

}  // namespace tectum
