// Saccades in a gaze trace, by velocity.
//
// Engbert & Kliegl 2003, Vision Res. 43:1035, doi:10.1016/S0042-6989(03)00084-1:
//   v_n     = (x_{n+2} + x_{n+1} - x_{n-1} - x_{n-2}) / (6 dt)        per axis
//   sigma^2 = median(v^2) - median(v)^2                               per axis
//   in a saccade while (v_x / (lambda sigma_x))^2 + (v_y / (lambda sigma_y))^2 > 1, lambda = 6,
//   for at least the minimum duration; events closer than the minimum gap are one.
//
// Two things are ours. A simulated eye can be perfectly still, where sigma is 0, so the threshold lambda * sigma
// has a floor. And a trace at a camera's rate is too coarse for five points (they span 89 ms at 45 Hz): below 150 Hz
// the velocity is the plain difference of neighbours, which finds saccades but understates their peak velocity.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tools/analysis/gaze_traces.h"

namespace tectum {

struct SaccadeOptions {
  double lambda = 6;
  double min_duration_s = 0.006;  // Engbert & Kliegl: 3 samples at 500 Hz
  double min_gap_s = 0.020;       // overshoots and rings belong to the saccade before
  double min_threshold_deg_s = 5;
  double min_amplitude_deg = 0;
};

struct Saccade {
  double onset_s = 0;
  double offset_s = 0;
  std::array<double, 2> from_deg{};  // pan, tilt at onset
  std::array<double, 2> to_deg{};    // at offset
  double amplitude_deg = 0;          // length of to - from
  double peak_velocity_deg_s = 0;    // of the speed sqrt(v_pan^2 + v_tilt^2)
  double duration_s = 0;
  /// Share of the duration at which the speed peaks; 0.5 is symmetric (Collewijn, Erkelens & Steinman 1988).
  double skewness = 0;
};

/// `trace` must be evenly sampled; fewer than 5 samples hold no saccade.
[[nodiscard]] std::vector<Saccade> detect_saccades(const AngleTrace& trace, const SaccadeOptions& options = {});

/// What suits a recording's frame-rate gaze: the floor lies above one 0.29 deg servo step a frame.
[[nodiscard]] SaccadeOptions frame_rate_saccade_options(double frame_period_s);

/// Onset minus the latest jump at or before it, for each first saccade after a jump.
[[nodiscard]] std::vector<double> saccade_latencies_s(const std::vector<Saccade>&, const std::vector<double>& jumps_s);

}  // namespace tectum
