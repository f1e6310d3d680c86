// Forward kinematics of the head: six joint angles to two optical axes.
#pragma once

#include <Eigen/Core>
#include <array>

#include "drivers/head/geometry.h"

namespace tectum {

using JointAngles = std::array<double, kJointCount>;  // degrees, in the order of tectum::Joint
using WallPoint = std::array<double, 2>;              // metres right and up of the point straight ahead

struct EyePose {
  Eigen::Vector3d position_m;  // optical centre, head-base frame
  Eigen::Matrix3d axes;        // columns: the eye's right, up and forward in the head-base frame
};

/// pan = atan2(x, z), tilt = atan2(y, hypot(x, z)).
struct Direction {
  double pan_deg = 0;
  double tilt_deg = 0;
};

[[nodiscard]] EyePose eye_pose(const HeadGeometry& geometry, const JointAngles& joint_deg, Eye eye);

[[nodiscard]] Eigen::Vector3d wall_to_base(const HeadGeometry& geometry, const WallPoint& point_m);

[[nodiscard]] Direction direction_of(const Eigen::Vector3d& vector);
/// Of a point in the fixed head-base frame, seen from the eye's position.
[[nodiscard]] Direction direction_from_eye(const EyePose& pose, const Eigen::Vector3d& point_m);
/// Of a point in the eye's own frame: the gaze error, zero when the optical axis passes through the point.
[[nodiscard]] Direction error_in_eye(const EyePose& pose, const Eigen::Vector3d& point_m);
/// Of the optical axis in the head-base frame.
[[nodiscard]] Direction gaze_direction(const EyePose& pose);

/// Where the optical axis meets the wall. An axis more than 87 deg off the wall's normal, or pointing away
/// from it, is taken to be at 87 deg, so that the point stays finite.
[[nodiscard]] WallPoint gaze_on_wall(const HeadGeometry& geometry, const EyePose& pose);

/// Pan and tilt of one eye that put a wall point on its optical axis, the neck at the given angles.
/// Not clipped to the joints' limits.
[[nodiscard]] Direction eye_angles_towards(const HeadGeometry& geometry, double neck_pan_deg, double neck_tilt_deg,
                                           Eye eye, const WallPoint& point_m);

}  // namespace tectum
