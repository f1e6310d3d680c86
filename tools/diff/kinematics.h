// What the eyes do in a run, in the numbers of the eye-movement literature.
#pragma once

#include <optional>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/analysis/gaze_traces.h"
#include "tools/diff/battery.h"

namespace tectum {

/// One number of a run; nothing where the run has no such event (an eye that never moves has no saccade).
struct KinematicFigure {
  const char* name;
  const char* unit;
  std::optional<double> value;
};

/// Eye and neck shafts added up, at Recording::positions where there are any: the direction of gaze for a neck near its
/// middle. Otherwise the gaze of the frames.
[[nodiscard]] AngleTrace shaft_trace(const Recording& recording, Eye eye);

/// Always the same figures in the same order. Means over both eyes, steps and parts; a target is where each eye sees
/// it:
///   fixation spread      standard deviation of the gaze while the target rests, both axes, deg
///   fixation RMSE        root mean square angle to the target then, from 200 ms on, deg
///   saccade amplitude, peak velocity, latency
///                        of the first saccade towards the target after each step (tools/analysis/saccades.h)
///   overshoot            farthest point beyond the target along the way from where the eye was, % of that way; 0 when
///                        it falls short
///   settled RMSE         root mean square angle to the target in the last 100 ms of each step, deg
///   pursuit RMSE         root mean square angle to the moving target, from 200 ms on, deg
///   pursuit gain         eye movement over target movement there, by least squares over both axes
///   RMSE                 root mean square angle to the target over the whole run, deg
[[nodiscard]] std::vector<KinematicFigure> kinematics(const Recording& recording, const std::vector<RunPart>& parts);

}  // namespace tectum
