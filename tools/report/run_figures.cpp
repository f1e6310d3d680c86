#include "tools/report/run_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr std::array<const char*, kEyeCount> kEyeNames = {"left eye", "right eye"};
constexpr std::array<const char*, kEyeCount> kEyeInks = {"left", "right"};
constexpr double kAx12aSpeedDegS = 354;  // ROBOTIS AX-12A, no load, 12 V

/// One axis of a trace, cut to the window; one sample beyond each end so that lines reach the border.
Series trace_series(const AngleTrace& trace, GazeAxis axis, const LaneWindow& window, std::string name,
                    std::string ink) {
  Series series;
  series.name = std::move(name);
  series.ink = std::move(ink);
  const std::vector<double>& angle_deg = axis == GazeAxis::Horizontal ? trace.pan_deg : trace.tilt_deg;
  for (std::size_t k = 0; k < trace.time_s.size(); ++k) {
    const bool is_near = (k + 1 >= trace.time_s.size() || trace.time_s[k + 1] >= window.begin_s) &&
                         (k == 0 || trace.time_s[k - 1] < window.end_s);
    if (is_near) {
      series.x.push_back(trace.time_s[k]);
      series.y.push_back(angle_deg[k]);
    }
  }
  return series;
}

Chart time_chart(const LaneWindow& window, std::string y_label, std::string description) {
  Chart chart;
  chart.description = std::move(description);
  chart.x = {"time (s)", window.begin_s, window.end_s, 0};
  chart.y.label = std::move(y_label);
  chart.y.min_span = 4;
  chart.has_cursor = true;
  return chart;
}

std::string axis_name(GazeAxis axis) { return axis == GazeAxis::Horizontal ? "horizontal" : "vertical"; }
std::string axis_label(GazeAxis axis) { return axis == GazeAxis::Horizontal ? "right + (deg)" : "up + (deg)"; }

void keep_within(const LaneWindow& window, const std::vector<double>& times_s, std::vector<double>& marks) {
  for (const double time_s : times_s) {
    if (time_s >= window.begin_s && time_s < window.end_s) {
      marks.push_back(time_s);
    }
  }
}

/// Cuts a trace where nothing was seen for longer than three frames.
void break_at_gaps(Series& series, double frame_period_s) {
  for (std::size_t k = 1; k < series.x.size(); ++k) {
    if (series.x[k] - series.x[k - 1] > 3.5 * frame_period_s) {
      series.x.insert(series.x.begin() + static_cast<std::ptrdiff_t>(k), series.x[k]);
      series.y.insert(series.y.begin() + static_cast<std::ptrdiff_t>(k), std::nan(""));
      ++k;
    }
  }
}

/// Shares of the samples in equal bins; what lies beyond the ends is counted in the end bins.
Series histogram(const std::vector<double>& sample, double low, double high, int bins, std::string name,
                 std::string ink) {
  Series series{SeriesKind::Bars, std::move(name), std::move(ink), {}, {}, 1.6, 0.55, false};
  const double width = (high - low) / bins;
  for (int k = 0; k < bins; ++k) {
    series.x.push_back(low + k * width);
    series.y.push_back(0);
  }
  for (const double value : sample) {
    const double bin = std::clamp(std::floor((value - low) / width), 0.0, static_cast<double>(bins - 1));
    series.y[static_cast<std::size_t>(bin)] += 100.0 / static_cast<double>(sample.size());
  }
  return series;
}

}  // namespace

Chart gaze_chart(const Recording& recording, GazeAxis axis, const LaneWindow& window,
                 const std::vector<double>& jumps_s) {
  Chart chart = time_chart(window, axis_label(axis), axis_name(axis) + " direction of target, eyes and neck over time");
  keep_within(window, jumps_s, chart.marks);
  const AngleTrace left = target_trace(recording, Eye::Left);
  const AngleTrace right = target_trace(recording, Eye::Right);
  if (!left.time_s.empty()) {
    if (axis == GazeAxis::Horizontal) {
      // The eyes sit apart, so a near target lies in two directions; they are drawn as the band's two edges.
      chart.series.push_back(trace_series(left, axis, window, "target, from left eye", "target"));
      chart.series.push_back(trace_series(right, axis, window, "from right eye", "target"));
      chart.series.back().is_dashed = true;
    } else {
      chart.series.push_back(trace_series(left, axis, window, "target", "target"));
    }
    for (Series& series : chart.series) {
      series.width_px = 2.6;
      series.kind = SeriesKind::Step;
    }
  }
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const auto e = static_cast<std::size_t>(eye);
    chart.series.push_back(trace_series(gaze_trace(recording, eye), axis, window, kEyeNames[e], kEyeInks[e]));
  }
  chart.series.push_back(trace_series(neck_trace(recording), axis, window, "neck", "neck"));
  return chart;
}

Chart error_chart(const Recording& recording, GazeAxis axis, const LaneWindow& window,
                  const std::vector<double>& jumps_s) {
  Chart chart = time_chart(window, axis_name(axis) + " error (deg)", axis_name(axis) + " gaze error over time");
  keep_within(window, jumps_s, chart.marks);
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const auto e = static_cast<std::size_t>(eye);
    chart.series.push_back(trace_series(error_trace(recording, eye), axis, window, kEyeNames[e], kEyeInks[e]));
  }
  return chart;
}

Chart seen_chart(const Recording& recording, GazeAxis axis, const LaneWindow& window) {
  Chart chart = time_chart(window, axis_label(axis), axis_name(axis) + " direction of the active receptive fields");
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const auto e = static_cast<std::size_t>(eye);
    Series series = trace_series(seen_direction_trace(recording, eye), axis, window, kEyeNames[e], kEyeInks[e]);
    break_at_gaps(series, static_cast<double>(recording.frame_period_ns) * 1e-9);
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Chart servo_chart(const Recording& recording, Joint joint, const LaneWindow& window) {
  const auto j = static_cast<std::size_t>(joint);
  AngleTrace goal;
  AngleTrace measured;
  for (const RecordedFrame& frame : recording.frames) {
    const double time_s = static_cast<double>(frame.time_ns) * 1e-9;
    goal.time_s.push_back(time_s);
    goal.pan_deg.push_back(frame.goal_deg[j]);
    measured.time_s.push_back(time_s);
    measured.pan_deg.push_back(frame.position_deg[j]);
  }
  Chart chart = time_chart(window, "(deg)", joint_title(joint) + ": commanded and measured angle");
  chart.series.push_back(trace_series(goal, GazeAxis::Horizontal, window, "told", "goal"));
  chart.series.back().kind = SeriesKind::Step;
  chart.series.back().width_px = 2.2;
  const bool is_left = joint == Joint::LeftEyePan || joint == Joint::LeftEyeTilt;
  const bool is_neck = joint == Joint::NeckPan || joint == Joint::NeckTilt;
  chart.series.push_back(trace_series(measured, GazeAxis::Horizontal, window, "measured",
                                      is_neck   ? "neck"
                                      : is_left ? "left"
                                                : "right"));
  return chart;
}

Chart wall_chart(const Recording& recording, const LaneWindow& window) {
  Chart chart;
  chart.description = "path of the target and of both optical axes on the wall";
  chart.x = {"right of straight ahead (cm)", std::nullopt, std::nullopt, 10};
  chart.y = {"up (cm)", std::nullopt, std::nullopt, 10};
  chart.has_equal_scales = true;
  std::array<Series, kEyeCount> gaze;
  Series target{SeriesKind::Points, "target", "target", {}, {}, 9, 0.9, false};
  for (const RecordedFrame& frame : recording.frames) {
    const double time_s = static_cast<double>(frame.time_ns) * 1e-9;
    if (!frame.has_truth || time_s < window.begin_s || time_s >= window.end_s) {
      continue;
    }
    const double x_cm = frame.target_on_wall_m[0] * 100;
    const double y_cm = frame.target_on_wall_m[1] * 100;
    if (target.x.empty() || target.x.back() != x_cm || target.y.back() != y_cm) {
      target.x.push_back(x_cm);
      target.y.push_back(y_cm);
    }
    for (std::size_t e = 0; e < kEyeCount; ++e) {
      gaze[e].x.push_back(frame.eye[e].gaze_on_wall_m[0] * 100);
      gaze[e].y.push_back(frame.eye[e].gaze_on_wall_m[1] * 100);
    }
  }
  // A target that moves smoothly is a path, not hundreds of dots.
  if (target.x.size() > 150) {
    target.kind = SeriesKind::Line;
    target.width_px = 4;
  }
  chart.series.push_back(std::move(target));
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    gaze[e].name = kEyeNames[e];
    gaze[e].ink = kEyeInks[e];
    gaze[e].width_px = 1.1;
    gaze[e].opacity = 0.8;
    chart.series.push_back(std::move(gaze[e]));
  }
  return chart;
}

Chart error_histogram(const Recording& recording, GazeAxis axis) {
  Chart chart;
  chart.description = "histogram of the " + axis_name(axis) + " error";
  chart.y = {"share of frames (%)", 0, std::nullopt, 1};
  std::array<std::vector<double>, kEyeCount> errors;
  double reach_deg = 2;
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const AngleTrace error = error_trace(recording, eye);
    std::vector<double>& sample = errors[static_cast<std::size_t>(eye)];
    sample = axis == GazeAxis::Horizontal ? error.pan_deg : error.tilt_deg;
    reach_deg = std::max(reach_deg, std::ceil(quantile(absolute(sample), 0.95)));
  }
  chart.x = {axis_name(axis) + " error (deg), ends: and beyond", -reach_deg, reach_deg, 0};
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    chart.series.push_back(histogram(errors[e], -reach_deg, reach_deg, 41, kEyeNames[e], kEyeInks[e]));
  }
  return chart;
}

Chart main_sequence_chart(const RunSummary& summary) {
  Chart chart;
  chart.description = "saccade peak velocity against amplitude";
  chart.x = {"amplitude (deg)", 0, std::nullopt, 5};
  chart.y = {"peak velocity (deg/s)", 0, std::nullopt, 100};
  double widest_deg = 10;
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    Series points{SeriesKind::Points, kEyeNames[e], kEyeInks[e], {}, {}, 5, 0.7, false};
    for (const Saccade& saccade : summary.saccades[e].saccades) {
      points.x.push_back(saccade.amplitude_deg);
      points.y.push_back(saccade.peak_velocity_deg_s);
      widest_deg = std::max(widest_deg, saccade.amplitude_deg);
    }
    chart.series.push_back(std::move(points));
  }
  // Bahill, Clark & Stark 1975, doi:10.1016/0025-5564(75)90075-9: an exponential approach; 700 deg/s and 7 deg are
  // the usual round numbers for people.
  Series human{SeriesKind::Line, "people", "muted", {}, {}, 1.6, 1, true};
  Series servo{SeriesKind::Line, "AX-12A at most", "c3", {}, {}, 1.2, 1, true};
  for (int k = 0; k <= 60; ++k) {
    const double amplitude_deg = widest_deg * k / 60;
    human.x.push_back(amplitude_deg);
    human.y.push_back(700 * (1 - std::exp(-amplitude_deg / 7)));
  }
  servo.x = {0, widest_deg};
  servo.y = {kAx12aSpeedDegS, kAx12aSpeedDegS};
  chart.series.push_back(std::move(human));
  chart.series.push_back(std::move(servo));
  return chart;
}

Chart latency_histogram(const RunSummary& summary) {
  Chart chart;
  chart.description = "histogram of saccade latencies";
  chart.x = {"first saccade after a target jump (ms), end: and later", 0, 500, 0};
  chart.y = {"share of jumps (%)", 0, std::nullopt, 1};
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    std::vector<double> latencies_ms;
    for (const double latency_s : summary.saccades[e].latencies_s) {
      latencies_ms.push_back(latency_s * 1e3);
    }
    chart.series.push_back(histogram(latencies_ms, 0, 500, 25, kEyeNames[e], kEyeInks[e]));
  }
  return chart;
}

LaneWindow zoom_window(const Recording& recording, const std::vector<double>& jumps_s, double length_s,
                       std::optional<double> begin_s) {
  const TimeRange range = time_range(recording);
  const double latest_s = std::max(range.begin_s, range.end_s - length_s);
  const auto window = [&](double from_s) {
    const double clamped_s = std::clamp(from_s, range.begin_s, latest_s);
    return LaneWindow{clamped_s, std::min(clamped_s + length_s, range.end_s)};
  };
  if (begin_s) {
    return window(*begin_s);
  }
  const double middle_s = (range.begin_s + range.end_s - length_s) / 2;
  LaneWindow best = window(middle_s);
  std::size_t most = 0;
  for (const double jump_s : jumps_s) {
    if (std::abs(jump_s - middle_s) > 10) {
      continue;
    }
    const LaneWindow candidate = window(jump_s - 0.25);
    const auto count = static_cast<std::size_t>(std::count_if(jumps_s.begin(), jumps_s.end(), [&](double other_s) {
      return other_s >= candidate.begin_s && other_s < candidate.end_s;
    }));
    if (count > most) {
      most = count;
      best = candidate;
    }
  }
  return best;
}

std::string joint_title(Joint joint) {
  std::string title = kJointNames[static_cast<std::size_t>(joint)];
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

}  // namespace tectum
