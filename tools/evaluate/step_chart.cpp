#include "tools/evaluate/step_chart.h"

#include <algorithm>
#include <cmath>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr double kCourseS = 2.5;
constexpr double kSmallestWayDeg = 2;

double period_s(const Recording& recording) { return static_cast<double>(recording.frame_period_ns) * 1e-9; }

}  // namespace

std::vector<double> median_course(const Recording& recording, double until_s) {
  const std::vector<double> jumps_s = target_jump_times_s(recording);
  const auto frames = static_cast<std::size_t>(until_s / period_s(recording)) + 1;
  std::vector<std::vector<double>> done(frames);
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const AngleTrace gaze = gaze_trace(recording, eye);
    const AngleTrace target = target_trace(recording, eye);
    for (std::size_t j = 0; j < jumps_s.size(); ++j) {
      const auto at = std::lower_bound(target.time_s.begin(), target.time_s.end(), jumps_s[j] - 1e-9);
      const auto first = static_cast<std::size_t>(at - target.time_s.begin());
      const double end_s = j + 1 < jumps_s.size() ? jumps_s[j + 1] - 1e-9 : INFINITY;
      const double from_pan_deg = gaze.pan_deg[first - 1], from_tilt_deg = gaze.tilt_deg[first - 1];
      const double way_pan_deg = target.pan_deg[first] - from_pan_deg;
      const double way_tilt_deg = target.tilt_deg[first] - from_tilt_deg;
      const double way_deg = std::hypot(way_pan_deg, way_tilt_deg);
      for (std::size_t k = first; k < gaze.time_s.size() && k - first < frames && gaze.time_s[k] < end_s; ++k) {
        if (way_deg >= kSmallestWayDeg) {
          done[k - first].push_back(
              ((gaze.pan_deg[k] - from_pan_deg) * way_pan_deg + (gaze.tilt_deg[k] - from_tilt_deg) * way_tilt_deg) /
              (way_deg * way_deg));
        }
      }
    }
  }
  std::vector<double> course;
  for (std::size_t k = 0; k < frames && !done[k].empty(); ++k) {
    course.push_back(median(done[k]));
  }
  return course;
}

Chart step_chart(const SettingResult& setting, const RecordedHead& recorded) {
  Chart chart;
  chart.description = "share of the way done after a jump: circuit, oracle, PID servo and the recorded head";
  chart.x = {.label = "since the jump (s)", .min = 0, .max = kCourseS};
  chart.y = {.label = "of the way done (%)", .min = {}, .max = {}};
  const auto add = [&](const Recording& recording, const char* name, const char* ink, bool is_dashed) {
    Series series{.kind = SeriesKind::Line, .name = name, .ink = ink, .x = {}, .y = {}, .is_dashed = is_dashed};
    const std::vector<double> course = median_course(recording, kCourseS);
    for (std::size_t k = 0; k < course.size(); ++k) {
      series.x.push_back(static_cast<double>(k) * period_s(recording));
      series.y.push_back(100 * course[k]);
    }
    chart.series.push_back(std::move(series));
  };
  add(recorded.result.first_trial, "recorded", "fg", true);
  add(setting.of(Controller::Oracle).first_trial, "oracle", "target", false);
  add(setting.of(Controller::Pid).first_trial, "pid", "right", false);
  add(setting.of(Controller::Circuit).first_trial, "circuit", "left", false);
  return chart;
}

}  // namespace tectum
