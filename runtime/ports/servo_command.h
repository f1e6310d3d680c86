// Joint angles in and out of the head, in the order of tectum::Joint.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/image/spike_image.h"
#include "runtime/ports/frame.h"

namespace tectum {

/// Goal angles in degrees from each joint's home position. Pan right and tilt up are positive.
struct ServoCommand {
  TimeNs issued_ns = 0;
  std::array<double, kJointCount> goal_deg{};
  bool torque_on = true;
  std::uint32_t joint_mask = (1U << kJointCount) - 1;  // bit j: this command is for Joint j
};

/// Last measured angles. A joint that has not answered keeps its old value and a clear bit in fresh_mask.
struct ServoFeedback {
  TimeNs measured_ns = 0;
  std::array<double, kJointCount> position_deg{};
  std::uint32_t fresh_mask = 0;
};

}  // namespace tectum
