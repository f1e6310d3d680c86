// How well the eyes stayed on the target, in the numbers that the seed paper and its successors report.
//
// The error of an eye is the true one: the target's direction minus the optical axis, in the eye's own frame, as pan
// and tilt, one sample a frame of the loop. (Balachandar & Michmizos 2020 instead subtract wall-referenced angles that
// they add up over eye and neck, with the opposite sign; `wall` below is that measure without the error of adding
// arctangents.)
//
//   median          signed median error: the paper's "RE" with the sign turned (Table I)
//   median_abs      median of |error|: what a bias-free observer would call the typical error
//   rmse            root mean square error: the paper's "RMSE" (Table I)
//   p90_abs         90th percentile of |error|
//   fovea_share     share of frames with |error| < 1 deg, the radius of the human foveola's surround that the protocol
//                   takes for "on the fovea"
//   settled         the same measures without the frames within 300 ms after a jump of the target: a controller
//                   cannot know of a jump at once, so `all` mixes delay with skill
//   jitter          peak-to-peak gaze within a hold of the target, from 300 ms after the jump to the next one; median
//                   over holds
//   neck travel     sum of |change| of the neck's measured angles
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "runtime/record/recording.h"

namespace tectum {

inline constexpr double kFoveaRadiusDeg = 1.0;
inline constexpr double kJumpBlankingS = 0.3;

struct ErrorStats {
  std::size_t frames = 0;
  double median_deg = 0;
  double median_abs_deg = 0;
  double rmse_deg = 0;
  double p90_abs_deg = 0;
  double fovea_share = 0;
};

struct AxisMetrics {
  ErrorStats all;
  ErrorStats settled;
  ErrorStats wall;        // all frames, wall-referenced: gaze minus target, as the paper counts it
  double jitter_deg = 0;  // 0 where no hold outlasts 300 ms
};

struct EyeMetrics {
  AxisMetrics pan;
  AxisMetrics tilt;
  ErrorStats angle;  // angle between the optical axis and the target; never negative
  ErrorStats angle_settled;
};

struct TrackingMetrics {
  bool has_truth = false;  // false: only the neck's travel is known
  std::array<EyeMetrics, kEyeCount> eye{};
  std::vector<double> target_jumps_s;
  double neck_pan_travel_deg = 0;
  double neck_tilt_travel_deg = 0;
};

[[nodiscard]] ErrorStats error_stats(const std::vector<double>& error_deg);
[[nodiscard]] TrackingMetrics tracking_metrics(const Recording&);

}  // namespace tectum
