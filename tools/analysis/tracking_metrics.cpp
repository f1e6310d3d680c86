#include "tools/analysis/tracking_metrics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// For each time: is it within [jump, jump + blanking) of the latest jump at or before it?
std::vector<bool> blanked(const std::vector<double>& time_s, const std::vector<double>& jumps_s) {
  std::vector<bool> is_blanked(time_s.size(), false);
  std::size_t next = 0;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    while (next < jumps_s.size() && jumps_s[next] <= time_s[k]) {
      ++next;
    }
    is_blanked[k] = next > 0 && time_s[k] - jumps_s[next - 1] < kJumpBlankingS;
  }
  return is_blanked;
}

std::vector<double> without(const std::vector<double>& values, const std::vector<bool>& is_blanked) {
  std::vector<double> kept;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!is_blanked[k]) {
      kept.push_back(values[k]);
    }
  }
  return kept;
}

/// Median over holds of max - min of the unblanked samples. A hold that no jump ends counts too.
double jitter_deg(const std::vector<double>& time_s, const std::vector<double>& gaze_deg,
                  const std::vector<double>& jumps_s, const std::vector<bool>& is_blanked) {
  if (jumps_s.empty()) {
    return 0;  // a target that never steps has no holds to speak of
  }
  std::vector<double> spans_deg;
  std::size_t next = 0;
  double low = 0;
  double high = 0;
  bool is_open = false;
  const auto close = [&] {
    if (is_open) {
      spans_deg.push_back(high - low);
    }
    is_open = false;
  };
  for (std::size_t k = 0; k < time_s.size() && k < gaze_deg.size(); ++k) {
    while (next < jumps_s.size() && jumps_s[next] <= time_s[k]) {
      close();
      ++next;
    }
    if (next == 0 || is_blanked[k]) {
      continue;
    }
    low = is_open ? std::min(low, gaze_deg[k]) : gaze_deg[k];
    high = is_open ? std::max(high, gaze_deg[k]) : gaze_deg[k];
    is_open = true;
  }
  close();
  return median(spans_deg);
}

double travel_deg(const std::vector<double>& angle_deg) {
  double sum_deg = 0;
  for (std::size_t k = 1; k < angle_deg.size(); ++k) {
    sum_deg += std::abs(angle_deg[k] - angle_deg[k - 1]);
  }
  return sum_deg;
}

/// Directions of two wall points from the point straight in front of the wall's origin, gaze minus target.
ErrorStats wall_stats(const Recording& recording, std::size_t eye, std::size_t axis) {
  std::vector<double> error_deg;
  for (const RecordedFrame& frame : recording.frames) {
    if (frame.has_truth && recording.wall_distance_m > 0) {
      const double gaze_rad = std::atan2(frame.eye[eye].gaze_on_wall_m[axis], recording.wall_distance_m);
      const double target_rad = std::atan2(frame.target_on_wall_m[axis], recording.wall_distance_m);
      error_deg.push_back((gaze_rad - target_rad) * kDegPerRad);
    }
  }
  return error_stats(error_deg);
}

EyeMetrics eye_metrics(const Recording& recording, Eye eye, const std::vector<double>& jumps_s) {
  const AngleTrace error = error_trace(recording, eye);
  const std::vector<bool> is_blanked = blanked(error.time_s, jumps_s);
  AngleTrace gaze;  // of the frames with truth, so that it lines up with the error
  for (const RecordedFrame& frame : recording.frames) {
    if (frame.has_truth) {
      gaze.pan_deg.push_back(frame.eye[static_cast<std::size_t>(eye)].gaze_pan_deg);
      gaze.tilt_deg.push_back(frame.eye[static_cast<std::size_t>(eye)].gaze_tilt_deg);
    }
  }
  std::vector<double> angle_deg;
  for (std::size_t k = 0; k < error.time_s.size(); ++k) {
    // cos(angle) = cos(pan) cos(tilt) for pan and tilt as longitude and latitude about the optical axis.
    const double cosine = std::cos(error.pan_deg[k] / kDegPerRad) * std::cos(error.tilt_deg[k] / kDegPerRad);
    angle_deg.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegPerRad);
  }
  const auto e = static_cast<std::size_t>(eye);
  EyeMetrics metrics;
  metrics.pan.all = error_stats(error.pan_deg);
  metrics.pan.settled = error_stats(without(error.pan_deg, is_blanked));
  metrics.pan.wall = wall_stats(recording, e, 0);
  metrics.pan.jitter_deg = jitter_deg(error.time_s, gaze.pan_deg, jumps_s, is_blanked);
  metrics.tilt.all = error_stats(error.tilt_deg);
  metrics.tilt.settled = error_stats(without(error.tilt_deg, is_blanked));
  metrics.tilt.wall = wall_stats(recording, e, 1);
  metrics.tilt.jitter_deg = jitter_deg(error.time_s, gaze.tilt_deg, jumps_s, is_blanked);
  metrics.angle = error_stats(angle_deg);
  metrics.angle_settled = error_stats(without(angle_deg, is_blanked));
  return metrics;
}

}  // namespace

ErrorStats error_stats(const std::vector<double>& error_deg) {
  ErrorStats stats;
  stats.frames = error_deg.size();
  if (error_deg.empty()) {
    return stats;
  }
  const std::vector<double> magnitude_deg = absolute(error_deg);
  stats.median_deg = median(error_deg);
  stats.median_abs_deg = median(magnitude_deg);
  stats.rmse_deg = root_mean_square(error_deg);
  stats.p90_abs_deg = quantile(magnitude_deg, 0.9);
  const auto on_fovea = std::count_if(magnitude_deg.begin(), magnitude_deg.end(),
                                      [](double value_deg) { return value_deg < kFoveaRadiusDeg; });
  stats.fovea_share = static_cast<double>(on_fovea) / static_cast<double>(magnitude_deg.size());
  return stats;
}

TrackingMetrics tracking_metrics(const Recording& recording) {
  TrackingMetrics metrics;
  const AngleTrace neck = neck_trace(recording);
  metrics.neck_pan_travel_deg = travel_deg(neck.pan_deg);
  metrics.neck_tilt_travel_deg = travel_deg(neck.tilt_deg);
  metrics.has_truth = has_truth(recording);
  if (!metrics.has_truth) {
    return metrics;
  }
  metrics.target_jumps_s = target_jump_times_s(recording);
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    metrics.eye[static_cast<std::size_t>(eye)] = eye_metrics(recording, eye, metrics.target_jumps_s);
  }
  return metrics;
}

}  // namespace tectum
