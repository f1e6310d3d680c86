// What the eyes do in a battery, in the numbers of the eye-movement literature.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/diff/battery.h"

namespace tectum {

/// One number of a run; nothing where the run has no such event (an eye that never moves has no saccade).
struct KinematicFigure {
  const char* name;
  const char* unit;
  std::optional<double> value;
};

/// Always the same figures in the same order. Means over both eyes, steps and parts of the battery:
///   fixation spread      standard deviation of the gaze while the target rests, both axes, deg
///   fixation error       root mean square angle to the target then, deg
///   saccade amplitude, peak velocity, latency
///                        of the first saccade after each step: tools/analysis/saccades.h, shafts sampled at 500 Hz
///   overshoot            farthest point beyond the target along the step, % of the step; 0 when it falls short
///   settled error        root mean square angle to the target in the last 100 ms of each step, deg
///   pursuit error        root mean square angle to the target on the ramp, from 200 ms on, deg
///   pursuit gain         eye speed over target speed there, by least squares
///   tracking error       root mean square angle to the target over the whole run, deg
[[nodiscard]] std::vector<KinematicFigure> kinematics(const Recording& recording, const Battery& battery);

}  // namespace tectum
