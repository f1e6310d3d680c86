#include "tools/analysis/saccades.h"

#include <algorithm>
#include <cmath>

#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr double kFivePointMinRateHz = 150;
constexpr double kServoStepDeg = 0.29;  // ROBOTIS AX-12A: 300 deg / 1024

/// Velocity with `velocity[n]` belonging to the motion around sample n (five points) or into it (neighbours).
std::vector<double> velocity(const std::vector<double>& angle_deg, double dt_s, bool is_five_point) {
  const std::size_t n = angle_deg.size();
  std::vector<double> v(n, 0.0);
  if (is_five_point) {
    for (std::size_t k = 2; k + 2 < n; ++k) {
      v[k] = (angle_deg[k + 2] + angle_deg[k + 1] - angle_deg[k - 1] - angle_deg[k - 2]) / (6 * dt_s);
    }
  } else {
    for (std::size_t k = 1; k < n; ++k) {
      v[k] = (angle_deg[k] - angle_deg[k - 1]) / dt_s;
    }
  }
  return v;
}

double robust_sd(const std::vector<double>& v) {
  std::vector<double> squares;
  squares.reserve(v.size());
  for (const double value : v) {
    squares.push_back(value * value);
  }
  const double middle = median(v);
  return std::sqrt(std::max(0.0, median(squares) - middle * middle));
}

struct Interval {
  std::size_t first = 0;  // half-open
  std::size_t last = 0;
};

/// Runs of true; runs with a gap under `min_gap` samples are joined, then runs under `min_length` are dropped.
std::vector<Interval> runs(const std::vector<bool>& is_fast, std::size_t min_gap, std::size_t min_length) {
  std::vector<Interval> found;
  for (std::size_t k = 0; k < is_fast.size();) {
    if (!is_fast[k]) {
      ++k;
      continue;
    }
    std::size_t end = k;
    while (end < is_fast.size() && is_fast[end]) {
      ++end;
    }
    if (end - k >= min_length) {
      if (!found.empty() && k - found.back().last < min_gap) {
        found.back().last = end;
      } else {
        found.push_back({k, end});
      }
    }
    k = end;
  }
  return found;
}

std::size_t samples(double duration_s, double dt_s) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(duration_s / dt_s - 1e-9)));
}

}  // namespace

std::vector<Saccade> detect_saccades(const AngleTrace& trace, const SaccadeOptions& options) {
  const std::size_t n = trace.time_s.size();
  std::vector<Saccade> saccades;
  if (n < 5 || trace.time_s.back() <= trace.time_s.front()) {
    return saccades;
  }
  const double dt_s = (trace.time_s.back() - trace.time_s.front()) / static_cast<double>(n - 1);
  const bool is_five_point = 1 / dt_s >= kFivePointMinRateHz;
  const std::vector<double> pan = velocity(trace.pan_deg, dt_s, is_five_point);
  const std::vector<double> tilt = velocity(trace.tilt_deg, dt_s, is_five_point);
  const double pan_limit = std::max(options.lambda * robust_sd(pan), options.min_threshold_deg_s);
  const double tilt_limit = std::max(options.lambda * robust_sd(tilt), options.min_threshold_deg_s);
  std::vector<bool> is_fast(n, false);
  for (std::size_t k = 0; k < n; ++k) {
    is_fast[k] = std::hypot(pan[k] / pan_limit, tilt[k] / tilt_limit) > 1;
  }
  for (const Interval& run : runs(is_fast, samples(options.min_gap_s, dt_s), samples(options.min_duration_s, dt_s))) {
    // A neighbour difference belongs to the interval that ends at its sample.
    const std::size_t first = is_five_point || run.first == 0 ? run.first : run.first - 1;
    const std::size_t last = run.last - 1;
    Saccade saccade;
    saccade.onset_s = trace.time_s[first];
    saccade.offset_s = trace.time_s[last];
    saccade.duration_s = saccade.offset_s - saccade.onset_s;
    saccade.from_deg = {trace.pan_deg[first], trace.tilt_deg[first]};
    saccade.to_deg = {trace.pan_deg[last], trace.tilt_deg[last]};
    saccade.amplitude_deg =
        std::hypot(saccade.to_deg[0] - saccade.from_deg[0], saccade.to_deg[1] - saccade.from_deg[1]);
    std::size_t peak = run.first;
    for (std::size_t k = run.first; k < run.last; ++k) {
      if (std::hypot(pan[k], tilt[k]) > saccade.peak_velocity_deg_s) {
        saccade.peak_velocity_deg_s = std::hypot(pan[k], tilt[k]);
        peak = k;
      }
    }
    saccade.skewness = saccade.duration_s > 0 ? (trace.time_s[peak] - saccade.onset_s) / saccade.duration_s : 0;
    if (saccade.amplitude_deg >= options.min_amplitude_deg) {
      saccades.push_back(saccade);
    }
  }
  return saccades;
}

SaccadeOptions frame_rate_saccade_options(double frame_period_s) {
  SaccadeOptions options;
  if (frame_period_s > 0) {
    options.min_threshold_deg_s = std::max(options.min_threshold_deg_s, 1.5 * kServoStepDeg / frame_period_s);
  }
  options.min_amplitude_deg = 2 * kServoStepDeg;
  return options;
}

std::vector<double> saccade_latencies_s(const std::vector<Saccade>& saccades, const std::vector<double>& jumps_s) {
  std::vector<double> latencies_s;
  std::size_t next = 0;
  for (std::size_t j = 0; j < jumps_s.size(); ++j) {
    while (next < saccades.size() && saccades[next].onset_s < jumps_s[j]) {
      ++next;
    }
    const bool is_before_next_jump =
        next < saccades.size() && (j + 1 == jumps_s.size() || saccades[next].onset_s < jumps_s[j + 1]);
    if (is_before_next_jump) {
      latencies_s.push_back(saccades[next].onset_s - jumps_s[j]);
    }
  }
  return latencies_s;
}

}  // namespace tectum
