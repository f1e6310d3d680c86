// Minutes on a still dot, small and large against the fovea: microsaccades by Engbert & Kliegl 2003, with their rule
// that both eyes must move at once, and the drift between them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/analysis/statistics.h"
#include "tools/evaluate/movement_trial.h"
#include "tools/evaluate/movements.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {
namespace {

constexpr double kSettledS = 3;  // after which the eyes have found the dot
constexpr double kDriftWindowS = 0.5;
constexpr double kDriftStrideS = 0.25;
constexpr double kDriftAfterPauseS = 0.05;  // the plant and the slide are done
constexpr double kDriftMeanS = 0.2;         // averaged at either end of a drift window
constexpr double kLargestDeg = 3;           // beyond is no microsaccade

struct Fixation {
  double minutes = 0;
  std::vector<Saccade> microsaccades;
  std::vector<double> pause_amplitude_deg;  // from before to after each pause of the OPN
  std::vector<double> drift_deg_s, error_deg;
  double scatter_deg = 0;
};

/// How far an eye is carried across each pause. The means reach below the spiking noise, which hides
/// movements of less than a degree from a threshold on velocity.
std::vector<double> pause_amplitudes_deg(const MovementTrial& trial) {
  constexpr double kMeanS = 0.08, kSettleS = 0.03;
  const AngleTrace& eye = trial.eye[0];
  std::vector<double> amplitudes_deg;
  for (const Pause& pause : trial.opn_pauses) {
    if (pause.begin_s > kSettledS) {
      const double to_s = pause.end_s + kSettleS;
      amplitudes_deg.push_back(std::hypot(mean_between(eye, eye.pan_deg, to_s, to_s + kMeanS) -
                                              mean_between(eye, eye.pan_deg, pause.begin_s - kMeanS, pause.begin_s),
                                          mean_between(eye, eye.tilt_deg, to_s, to_s + kMeanS) -
                                              mean_between(eye, eye.tilt_deg, pause.begin_s - kMeanS, pause.begin_s)));
    }
  }
  return amplitudes_deg;
}

/// Those of the left eye that overlap one of the right eye by a sample at least.
std::vector<Saccade> binocular(const std::vector<Saccade>& left, const std::vector<Saccade>& right) {
  std::vector<Saccade> both;
  for (const Saccade& each : left) {
    const bool overlaps = std::any_of(right.begin(), right.end(), [&](const Saccade& other) {
      return other.onset_s <= each.offset_s && other.offset_s >= each.onset_s;
    });
    if (overlaps && each.onset_s > kSettledS && each.amplitude_deg < kLargestDeg) {
      both.push_back(each);
    }
  }
  return both;
}

/// Root mean square distance from the mean direction.
double scatter_deg(const AngleTrace& gaze) {
  const double middle_pan_deg = mean_between(gaze, gaze.pan_deg, kSettledS, 1e9);
  const double middle_tilt_deg = mean_between(gaze, gaze.tilt_deg, kSettledS, 1e9);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < gaze.time_s.size(); ++k) {
    if (gaze.time_s[k] >= kSettledS) {
      sum += std::pow(gaze.pan_deg[k] - middle_pan_deg, 2) + std::pow(gaze.tilt_deg[k] - middle_tilt_deg, 2);
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

/// The way of the eye in each half second without a pause, over that time. The servos' steps of 0.29 deg would hide it.
std::vector<double> drifts_deg_s(const MovementTrial& trial) {
  const AngleTrace& eye = trial.eye[0];
  std::vector<double> found;
  for (double from_s = kSettledS; from_s + kDriftWindowS + kDriftMeanS < trial.recording.duration_s;
       from_s += kDriftStrideS) {
    const double to_s = from_s + kDriftWindowS;
    const bool is_interrupted = std::any_of(trial.opn_pauses.begin(), trial.opn_pauses.end(), [&](const Pause& p) {
      return p.end_s + kDriftAfterPauseS >= from_s && p.begin_s < to_s + kDriftMeanS;
    });
    if (!is_interrupted) {
      found.push_back(std::hypot(mean_between(eye, eye.pan_deg, to_s, to_s + kDriftMeanS) -
                                     mean_between(eye, eye.pan_deg, from_s, from_s + kDriftMeanS),
                                 mean_between(eye, eye.tilt_deg, to_s, to_s + kDriftMeanS) -
                                     mean_between(eye, eye.tilt_deg, from_s, from_s + kDriftMeanS)) /
                      kDriftWindowS);
    }
  }
  return found;
}

Fixation fixation_of(const MovementTrial& trial) {
  Fixation found;
  found.minutes = (trial.recording.duration_s - kSettledS) / 60;
  found.microsaccades = binocular(detect_saccades(trial.eye[0]), detect_saccades(trial.eye[1]));
  found.pause_amplitude_deg = pause_amplitudes_deg(trial);
  const AngleTrace error = error_trace(trial.recording, Eye::Left);
  for (std::size_t k = 0; k < error.time_s.size(); ++k) {
    if (error.time_s[k] >= kSettledS) {
      found.error_deg.push_back(std::hypot(error.pan_deg[k], error.tilt_deg[k]));
    }
  }
  const AngleTrace gaze = gaze_trace(trial.recording, Eye::Left);
  found.scatter_deg = scatter_deg(gaze);
  found.drift_deg_s = drifts_deg_s(trial);
  return found;
}

struct Pooled {
  std::vector<double> pause_deg, amplitude_deg, peak_deg_s, drift_deg_s, error_deg, scatter_deg;
  double minutes = 0;
};

Pooled pool(const std::vector<Fixation>& trials) {
  Pooled all;
  for (const Fixation& trial : trials) {
    all.minutes += trial.minutes;
    all.pause_deg.insert(all.pause_deg.end(), trial.pause_amplitude_deg.begin(), trial.pause_amplitude_deg.end());
    for (const Saccade& s : trial.microsaccades) {
      all.amplitude_deg.push_back(s.amplitude_deg);
      all.peak_deg_s.push_back(s.peak_velocity_deg_s);
    }
    all.drift_deg_s.insert(all.drift_deg_s.end(), trial.drift_deg_s.begin(), trial.drift_deg_s.end());
    all.error_deg.insert(all.error_deg.end(), trial.error_deg.begin(), trial.error_deg.end());
    all.scatter_deg.push_back(trial.scatter_deg);
  }
  return all;
}

double radius_deg(double radius_m, double distance_m) { return std::atan(radius_m / distance_m) * 57.29577951; }

std::optional<double> middle(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional<double>(median(values));
}

MeasureRow row_of(double radius_m, double distance_m, const Pooled& all) {
  return {fmt::format("dot of {:.2f} deg radius", radius_deg(radius_m, distance_m)),
          {static_cast<double>(all.pause_deg.size()) / (60 * all.minutes), middle(all.pause_deg),
           static_cast<double>(all.amplitude_deg.size()) / (60 * all.minutes), middle(all.amplitude_deg),
           middle(all.peak_deg_s), middle(all.drift_deg_s),
           all.drift_deg_s.empty() ? std::nullopt : std::optional<double>(quantile(all.drift_deg_s, 0.9)),
           middle(all.scatter_deg), middle(all.error_deg)}};
}

/// Whether dots beyond the fovea make microsaccades and dots inside it none, as a row for each thing asked.
MeasureTable verdict_of(double fovea_deg, const Pooled& larger, const Pooled& smaller) {
  MeasureTable table;
  table.title = fmt::format("asked of a fovea of {:g} deg radius", fovea_deg);
  table.columns = {{"seen", "", 2}, {"at least", "", 2}, {"at most", "", 2}};
  std::size_t shown = 0;
  const auto ask = [&](const char* what, std::optional<double> seen, double low, double high) {
    const bool passes = seen && *seen >= low && *seen <= high;
    shown += passes ? 1U : 0U;
    table.rows.push_back({fmt::format("{} {}", passes ? "shows " : "MISSES", what), {seen, low, high}});
  };
  const auto rate_hz = [](const Pooled& all) {
    return all.minutes > 0 ? std::optional<double>(static_cast<double>(all.amplitude_deg.size()) / (60 * all.minutes))
                           : std::nullopt;
  };
  std::vector<double> over_main_sequence;
  for (std::size_t k = 0; k < larger.amplitude_deg.size(); ++k) {
    over_main_sequence.push_back(larger.peak_deg_s[k] / (700 * (1 - std::exp(-larger.amplitude_deg[k] / 7))));
  }
  ask("larger dots: microsaccades a second", rate_hz(larger), 0.5, 3);
  ask("larger dots: their amplitude (deg)", middle(larger.amplitude_deg), 0.1, 1);
  ask("larger dots: peak velocity over the main sequence", middle(over_main_sequence), 0.5, 2);
  ask("larger dots: drift (deg/s)", middle(larger.drift_deg_s), 0, 0.2);
  ask("smaller dots: microsaccades a second", rate_hz(smaller), 0, 0.05);
  ask("smaller dots: drift (deg/s)", middle(smaller.drift_deg_s), 0, 0.2);
  table.notes = {
      fmt::format("{} of {} shown; main sequence: 700 deg/s (1 - exp(-A / 7 deg))", shown, table.rows.size())};
  return table;
}

Chart error_chart(const Recording& recording) {
  constexpr double kFromS = 10, kToS = 30;
  const AngleTrace error = error_trace(recording, Eye::Left);
  Chart chart;
  chart.description = "error of the left eye over 20 s of fixation";
  chart.x = {.label = "time (s)", .min = kFromS, .max = kToS};
  chart.y = {.label = "error (deg)", .min = {}, .max = {}, .min_span = 2};
  for (const auto& [name, ink, values] :
       {std::tuple{"pan", "left", &error.pan_deg}, {"tilt", "right", &error.tilt_deg}}) {
    Series series{.kind = SeriesKind::Line, .name = name, .ink = ink, .x = {}, .y = {}};
    for (std::size_t k = 0; k < error.time_s.size(); ++k) {
      if (error.time_s[k] >= kFromS && error.time_s[k] < kToS) {
        series.x.push_back(error.time_s[k]);
        series.y.push_back((*values)[k]);
      }
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

MeasuredProtocol measure_fixation(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                  const std::function<void(double)>& progress) {
  const std::vector<double>& radii_m = protocol.movement.radii_m;
  const auto trials = static_cast<std::size_t>(protocol.trials);
  std::vector<std::vector<Fixation>> found(radii_m.size(), std::vector<Fixation>(trials));
  std::vector<Chart> charts(radii_m.size());
  std::vector<Job> jobs;
  for (std::size_t k = 0; k < radii_m.size() * trials; ++k) {
    jobs.emplace_back([&, k](const std::function<void(double)>& report) {
      SimulatedRunOptions options =
          trial_options(image, protocol, settings_of(protocol).front(), protocol.first_seed + k % trials);
      options.head.scenario.kind = ScenarioKind::Path;
      // A place of its own in every trial, so that no result hangs on one pixel.
      const double turn = 2.39996323 * static_cast<double>(k % trials);
      options.head.scenario.path = {{0, place_m(3 * std::cos(turn), 2 * std::sin(turn), protocol.wall_distance_m), 0}};
      options.head.camera.dot_radius_m = radii_m[k / trials];
      const MovementTrial moved = run_movement(image, options, report);
      found[k / trials][k % trials] = fixation_of(moved);
      if (k % trials == 0) {
        charts[k / trials] = error_chart(moved.recording);
      }
    });
  }
  run_jobs(jobs, threads, progress);
  MeasuredProtocol measures;
  MeasureTable table;
  table.title =
      fmt::format("fixation: {:g} s on a still dot (left eye; both eyes for microsaccades)", protocol.duration_s);
  table.columns = {{"OPN pauses", "1/s", 2},       {"each moves", "deg", 2}, {"by velocity", "1/s", 2},
                   {"amplitude", "deg", 2},        {"peak", "deg/s", 0},     {"drift", "deg/s", 3},
                   {"drift, 9 in 10", "deg/s", 3}, {"scatter", "deg", 2},    {"|error|", "deg", 2}};
  for (std::size_t r = 0; r < radii_m.size(); ++r) {
    table.rows.push_back(row_of(radii_m[r], protocol.wall_distance_m, pool(found[r])));
    measures.pictures.push_back({table.rows.back().what, "", charts[r]});
  }
  table.notes = {
      "OPN pauses: the neural mark of a saccade, however small, and how far the eye moves across it; by velocity: "
      "microsaccades by Engbert & Kliegl (lambda 6, 6 ms, both eyes at once); both of what the motoneurons would do to "
      "a "
      "human eye, whose spiking noise hides what is smaller than about 0.3 deg",
      "drift: way of that eye in half a second without a pause; scatter and error: of the servos",
      "people: 1 to 2 a second, 0.2 to 0.6 deg; the 2020 head made them when its fovea was smaller than the dot"};
  measures.tables = {table};
  if (protocol.movement.fovea_deg > 0) {
    std::vector<Fixation> larger, smaller;
    for (std::size_t r = 0; r < radii_m.size(); ++r) {
      const bool is_larger = radius_deg(radii_m[r], protocol.wall_distance_m) > protocol.movement.fovea_deg;
      std::vector<Fixation>& side = is_larger ? larger : smaller;
      side.insert(side.end(), found[r].begin(), found[r].end());
    }
    measures.tables.push_back(verdict_of(protocol.movement.fovea_deg, pool(larger), pool(smaller)));
  }
  return measures;
}

}  // namespace tectum
