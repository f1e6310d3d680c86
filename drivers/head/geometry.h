// Where the head's axes, eyes and wall are. Lengths in metres, angles in degrees.
//
// The head-base frame: x right, y up, z forward. Its origin lies on the neck's pan axis, at the height of
// the cameras when every joint is at home, so that the wall is the plane z = wall_distance_m and the point
// straight ahead is (0, 0) on it. Pan is positive to the right, tilt positive up.
#pragma once

#include <array>
#include <cstddef>

#include "runtime/image/spike_image.h"

namespace tectum {

struct JointLimits {
  double min_deg = 0;
  double max_deg = 0;
};

/// Chain of each eye: neck pan, neck tilt, eye pan, eye tilt, camera.
///
/// The offsets between the axes are those of the frames in which the 2022 controller of this head was measured
/// (github.com/combra-lab/spiking-oculomotor-head-control, servo_pos_tf_tree.py). The 2020 paper prints none.
struct HeadGeometry {
  double wall_distance_m = 0.55;              // arXiv 2002.07534: wall 55 cm away (2022: 0.5865)
  double eye_half_baseline_m = 0.060;         // each eye's pan axis to the side of the neck's pan axis
  double neck_tilt_to_eye_forward_m = 0.005;  // neck tilt axis to eye pan axis
  double neck_tilt_to_eye_tilt_up_m = 0.112;  // 0.068 to the eye's pan servo, 0.044 on to its tilt axis
  double eye_tilt_to_camera_up_m = 0.054;     // the camera sits above the tilt axis and turns about it

  /// What the mechanics allow, joint by joint in the order of tectum::Joint: the whole range that the paper
  /// states, 100 deg horizontally and 70 deg vertically. The clamps of the 2020 program (eye pan 49.8 lateral and
  /// 38.1 medial, eye tilt +-17.6, neck pan +-32.2, neck tilt +-29.3) lie inside it and belong to the circuit's joints.
  std::array<JointLimits, kJointCount> limits = {{{-50, 50}, {-35, 35}, {-50, 50}, {-35, 35}, {-50, 50}, {-35, 35}}};
};

inline constexpr std::size_t index_of(Joint joint) { return static_cast<std::size_t>(joint); }
inline constexpr std::size_t index_of(Eye eye) { return static_cast<std::size_t>(eye); }

}  // namespace tectum
