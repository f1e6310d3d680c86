#include "drivers/head/kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tectum {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Turns forward towards right.
Matrix3d pan_rotation(double deg) {
  const double c = std::cos(deg * kRadPerDeg);
  const double s = std::sin(deg * kRadPerDeg);
  Matrix3d m;
  m << c, 0, s, 0, 1, 0, -s, 0, c;
  return m;
}

// Turns forward towards up.
Matrix3d tilt_rotation(double deg) {
  const double c = std::cos(deg * kRadPerDeg);
  const double s = std::sin(deg * kRadPerDeg);
  Matrix3d m;
  m << 1, 0, 0, 0, c, s, 0, -s, c;
  return m;
}

}  // namespace

EyePose eye_pose(const HeadGeometry& geometry, const JointAngles& joint_deg, Eye eye) {
  const bool left = eye == Eye::Left;
  const Matrix3d neck =
      pan_rotation(joint_deg[index_of(Joint::NeckPan)]) * tilt_rotation(joint_deg[index_of(Joint::NeckTilt)]);
  const double pan_deg = joint_deg[index_of(left ? Joint::LeftEyePan : Joint::RightEyePan)];
  const double tilt_deg = joint_deg[index_of(left ? Joint::LeftEyeTilt : Joint::RightEyeTilt)];

  const Vector3d neck_tilt_axis(0, -(geometry.neck_tilt_to_eye_tilt_up_m + geometry.eye_tilt_to_camera_up_m), 0);
  const Vector3d eye_tilt_axis((left ? -1 : 1) * geometry.eye_half_baseline_m, geometry.neck_tilt_to_eye_tilt_up_m,
                               geometry.neck_tilt_to_eye_forward_m);
  const Vector3d camera(0, geometry.eye_tilt_to_camera_up_m, 0);

  EyePose pose;
  pose.axes = neck * pan_rotation(pan_deg) * tilt_rotation(tilt_deg);
  pose.position_m = neck_tilt_axis + neck * eye_tilt_axis + pose.axes * camera;
  return pose;
}

Vector3d wall_to_base(const HeadGeometry& geometry, const WallPoint& point_m) {
  return {point_m[0], point_m[1], geometry.wall_distance_m};
}

Direction direction_of(const Vector3d& vector) {
  return {std::atan2(vector.x(), vector.z()) / kRadPerDeg,
          std::atan2(vector.y(), std::hypot(vector.x(), vector.z())) / kRadPerDeg};
}

Direction direction_from_eye(const EyePose& pose, const Vector3d& point_m) {
  return direction_of(point_m - pose.position_m);
}

Direction error_in_eye(const EyePose& pose, const Vector3d& point_m) {
  return direction_of(pose.axes.transpose() * (point_m - pose.position_m));
}

Direction gaze_direction(const EyePose& pose) { return direction_of(pose.axes.col(2)); }

WallPoint gaze_on_wall(const HeadGeometry& geometry, const EyePose& pose) {
  constexpr double kSmallestForward = 0.0523;  // cos 87 deg
  const Vector3d axis = pose.axes.col(2);
  const double range_m = (geometry.wall_distance_m - pose.position_m.z()) / std::max(axis.z(), kSmallestForward);
  return {pose.position_m.x() + range_m * axis.x(), pose.position_m.y() + range_m * axis.y()};
}

Direction eye_angles_towards(const HeadGeometry& geometry, double neck_pan_deg, double neck_tilt_deg, Eye eye,
                             const WallPoint& point_m) {
  const bool left = eye == Eye::Left;
  const Vector3d target = wall_to_base(geometry, point_m);
  JointAngles joint_deg{};
  joint_deg[index_of(Joint::NeckPan)] = neck_pan_deg;
  joint_deg[index_of(Joint::NeckTilt)] = neck_tilt_deg;
  double& pan_deg = joint_deg[index_of(left ? Joint::LeftEyePan : Joint::RightEyePan)];
  double& tilt_deg = joint_deg[index_of(left ? Joint::LeftEyeTilt : Joint::RightEyeTilt)];
  // The pan axis does not depend on the tilt, so pan is exact at once; the camera moves with tilt by a tenth of the
  // distance to the wall, so each turn takes the remaining error down by about as much.
  constexpr int kTurns = 12;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Direction error = error_in_eye(eye_pose(geometry, joint_deg, eye), target);
    pan_deg += error.pan_deg;
    tilt_deg += error.tilt_deg;
  }
  return {pan_deg, tilt_deg};
}

}  // namespace tectum
