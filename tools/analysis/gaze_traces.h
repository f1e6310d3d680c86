// A recording as plain columns over time: gaze, target, error, joints.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/record/recording.h"

namespace tectum {

/// Directions over time, one sample a frame. Pan right and tilt up are positive.
struct AngleTrace {
  std::vector<double> time_s;
  std::vector<double> pan_deg;
  std::vector<double> tilt_deg;
};

/// Optical axis in the head-base frame. Where the recording has no truth, the sum of the measured eye
/// and neck angles stands in for it (exact only for a neck at home).
[[nodiscard]] AngleTrace gaze_trace(const Recording&, Eye);

/// Eye and neck shafts added up, at the rate at which the recording samples them: the direction of gaze for a neck near
/// its middle.
[[nodiscard]] AngleTrace sampled_gaze_trace(const Recording&, Eye);

/// The target's direction seen from the eye, head-base frame; only frames with truth.
[[nodiscard]] AngleTrace target_trace(const Recording&, Eye);

/// Target minus optical axis in the eye's own frame (`EyeTruth::error_*`); only frames with truth.
[[nodiscard]] AngleTrace error_trace(const Recording&, Eye);

[[nodiscard]] AngleTrace neck_trace(const Recording&);

/// Mean direction of the centres of an eye's active fields, in the eye's own frame; only frames with an
/// active field. Pinhole: pan = atan((x - w/2) / f), f = (w/2) / tan(fov/2).
[[nodiscard]] AngleTrace seen_direction_trace(const Recording&, Eye);

/// Times of the frames in which the target has stepped to a new place since the frame before: its direction from the
/// point the wall distance away moved by at least 0.5 deg, and at least four times as far as in the frame before and in
/// the frame after, which tells a step from smooth motion.
[[nodiscard]] std::vector<double> target_jump_times_s(const Recording&);

/// Time of the first frame, and one frame period past the last one.
struct TimeRange {
  double begin_s = 0;
  double end_s = 0;
};
[[nodiscard]] TimeRange time_range(const Recording&);

[[nodiscard]] bool has_truth(const Recording&);

}  // namespace tectum
