#include "tools/evaluate/step_response.h"

#include <algorithm>
#include <cmath>

#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr double kStartedShare = 0.1;

StepResponse response(const AngleTrace& gaze, const AngleTrace& target, std::size_t first, std::size_t last,
                      const StepOptions& options) {
  StepResponse step;
  step.at_s = target.time_s[first];
  const double pan_deg = target.pan_deg[first] - target.pan_deg[first - 1];
  const double tilt_deg = target.tilt_deg[first] - target.tilt_deg[first - 1];
  step.size_deg = std::hypot(pan_deg, tilt_deg);
  const double hold_s = target.time_s[last - 1] - step.at_s;
  step.latency_s = hold_s;
  step.settled_s = hold_s;
  // From where the eye was to where the target is: an eye that had not arrived yet has a different way to go.
  const double from_pan_deg = gaze.pan_deg[first - 1];
  const double from_tilt_deg = gaze.tilt_deg[first - 1];
  const double way_pan_deg = target.pan_deg[first] - from_pan_deg;
  const double way_tilt_deg = target.tilt_deg[first] - from_tilt_deg;
  const double way_deg = std::max(std::hypot(way_pan_deg, way_tilt_deg), 1e-9);
  bool has_started = false;
  std::size_t arrived = last;
  double beyond = 0;
  for (std::size_t k = first; k < last; ++k) {
    const double done =
        ((gaze.pan_deg[k] - from_pan_deg) * way_pan_deg + (gaze.tilt_deg[k] - from_tilt_deg) * way_tilt_deg) /
        (way_deg * way_deg);
    if (!has_started && done >= kStartedShare) {
      has_started = true;
      step.latency_s = gaze.time_s[k] - step.at_s;
    }
    beyond = std::max(beyond, done - 1);
    const double error_deg = std::hypot(gaze.pan_deg[k] - target.pan_deg[k], gaze.tilt_deg[k] - target.tilt_deg[k]);
    arrived = error_deg > options.settled_within_deg ? last : std::min(arrived, k);
  }
  step.overshoot_share = beyond * way_deg / std::max(step.size_deg, 1e-9);
  step.has_settled = arrived < last;
  if (step.has_settled) {
    step.settled_s = gaze.time_s[arrived] - step.at_s;
  }
  return step;
}

}  // namespace

std::vector<StepResponse> step_responses(const AngleTrace& gaze, const AngleTrace& target,
                                         const std::vector<double>& jumps_s, const StepOptions& options) {
  std::vector<StepResponse> found;
  const std::size_t samples = std::min(gaze.time_s.size(), target.time_s.size());
  const auto sample_at = [&](double time_s) {
    const auto at = std::lower_bound(target.time_s.begin(), target.time_s.end(), time_s - 1e-9);
    return std::min(static_cast<std::size_t>(at - target.time_s.begin()), samples);
  };
  for (std::size_t j = 0; j < jumps_s.size(); ++j) {
    const std::size_t first = sample_at(jumps_s[j]);
    const std::size_t last = j + 1 < jumps_s.size() ? sample_at(jumps_s[j + 1]) : samples;
    if (first == 0 || last < first + 2) {
      continue;
    }
    const StepResponse step = response(gaze, target, first, last, options);
    if (step.size_deg >= options.smallest_deg) {
      found.push_back(step);
    }
  }
  return found;
}

StepSummary summarize_steps(const std::vector<StepResponse>& responses) {
  StepSummary summary;
  std::vector<double> latency_s, overshoot, settled_s;
  for (const StepResponse& step : responses) {
    latency_s.push_back(step.latency_s);
    overshoot.push_back(step.overshoot_share);
    settled_s.push_back(step.settled_s);
    summary.settled += step.has_settled ? 1U : 0U;
  }
  summary.steps = responses.size();
  summary.median_latency_s = median(latency_s);
  summary.median_overshoot_share = median(overshoot);
  summary.p90_overshoot_share = quantile(overshoot, 0.9);
  summary.median_settled_s = median(settled_s);
  summary.p90_settled_s = quantile(settled_s, 0.9);
  return summary;
}

}  // namespace tectum
