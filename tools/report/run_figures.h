// The charts of a run report, from a recording.
#pragma once

#include <optional>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/analysis/run_summary.h"
#include "tools/report/chart.h"
#include "tools/report/lane_plot.h"

namespace tectum {

enum class GazeAxis { Horizontal, Vertical };

/// Target, both eyes' gaze and the neck.
[[nodiscard]] Chart gaze_chart(const Recording&, GazeAxis, const LaneWindow&, const std::vector<double>& jumps_s);
[[nodiscard]] Chart error_chart(const Recording&, GazeAxis, const LaneWindow&, const std::vector<double>& jumps_s);
/// Direction of what each eye's active fields cover, in the eye's frame: all that a run on video knows of the target.
[[nodiscard]] Chart seen_chart(const Recording&, GazeAxis, const LaneWindow&);
[[nodiscard]] Chart servo_chart(const Recording&, Joint, const LaneWindow&);
/// Where target and optical axes meet the wall, in cm from the point straight ahead.
[[nodiscard]] Chart wall_chart(const Recording&, const LaneWindow&);
[[nodiscard]] Chart error_histogram(const Recording&, GazeAxis);
[[nodiscard]] Chart main_sequence_chart(const RunSummary&);
[[nodiscard]] Chart latency_histogram(const RunSummary&);

/// The five seconds (or what `length_s` says) that show most: the window around the middle of the run that holds the
/// most target jumps, or simply the middle where there are none.
[[nodiscard]] LaneWindow zoom_window(const Recording&, const std::vector<double>& jumps_s, double length_s,
                                     std::optional<double> begin_s = std::nullopt);

/// "left eye pan" from Joint::LeftEyePan.
[[nodiscard]] std::string joint_title(Joint);

}  // namespace tectum
