// A dot that moves: step-ramps (Rashbass 1961: the step back saves the first saccade) and sinusoids.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/analysis/statistics.h"
#include "tools/evaluate/movement_trial.h"
#include "tools/evaluate/movements.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/evaluate/reference_run.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {
namespace {

constexpr double kSwingDeg = 10;  // of the sinusoids; half the way of the ramps
constexpr double kStepBackS = 0.15;
constexpr double kRestS = 1;
constexpr double kOnsetS = 0.3;       // of a ramp, before its steady part
constexpr double kCatchUpDegS = 100;  // above ramps and the noise of the command
constexpr int kSinusoidPoints = 60;
constexpr double kSinusoidS = 20;

struct Stretch {
  double from_s = 0, to_s = 0;
  std::array<double, 2> velocity_deg_s{};  // of a ramp; zero: a sinusoid
};

struct Plan {
  std::string what;
  std::vector<PathPoint> path;
  std::vector<Stretch> stretches;
  double duration_s = 0;
  double period_s = 0;
};

Plan ramps(double speed_deg_s, double wall_m) {
  Plan plan;
  plan.what = fmt::format("ramp {:g} deg/s", speed_deg_s);
  double now_s = 0;
  for (const std::array<double, 2>& axis : {std::array<double, 2>{1, 0}, std::array<double, 2>{-1, 0},
                                            std::array<double, 2>{0, 1}, std::array<double, 2>{0, -1}}) {
    const auto at = [&](double deg) { return place_m(deg * axis[0], deg * axis[1], wall_m); };
    plan.path.push_back({now_s, at(0), 0});
    now_s += kRestS;
    plan.path.push_back({now_s, at(0), 0});
    const double last_s = (kSwingDeg + kStepBackS * speed_deg_s) / speed_deg_s;
    constexpr int kPieces = 16;  // a constant speed on the wall is no constant angular speed
    for (int k = 0; k <= kPieces; ++k) {
      const double share = static_cast<double>(k) / kPieces;
      plan.path.push_back({now_s + share * last_s, at(-kStepBackS * speed_deg_s + share * speed_deg_s * last_s), 0});
    }
    plan.stretches.push_back({now_s, now_s + last_s, {speed_deg_s * axis[0], speed_deg_s * axis[1]}});
    now_s += last_s;
    plan.path.push_back({now_s + kRestS, at(kSwingDeg), 0});
    plan.path.push_back({now_s + 2 * kRestS, at(0), 0});
    now_s += 2 * kRestS;
  }
  plan.duration_s = now_s;
  return plan;
}

Plan sinusoid(double period_s, double wall_m) {
  Plan plan;
  plan.what = fmt::format("sinusoid {:.2g} Hz", 1 / period_s);
  plan.period_s = period_s;
  plan.path.push_back({0, {0, 0}, 0});
  const int cycles = std::max(2, static_cast<int>(std::ceil(kSinusoidS / period_s)));
  for (int k = 0; k <= cycles * kSinusoidPoints; ++k) {
    const double turn = static_cast<double>(k) / kSinusoidPoints;
    plan.path.push_back(
        {kRestS + turn * period_s, place_m(kSwingDeg * std::sin(2 * std::numbers::pi * turn), 0, wall_m), 0});
  }
  plan.duration_s = kRestS + cycles * period_s;
  plan.stretches.push_back({kRestS + period_s, plan.duration_s, {}});
  return plan;
}

struct Followed {
  std::vector<double> gain, smooth_gain, latency_ms, lag_ms;
  double catch_ups = 0, watched_s = 0;
};

/// Way along `velocity` over the time between saccades, over what the target goes in that time.
double smooth_gain(const MovementTrial& trial, const std::vector<Saccade>& saccades, const Stretch& stretch,
                   double speed_deg_s) {
  const AngleTrace& eye = trial.command[0];
  constexpr double kAroundS = 0.02;
  double way_deg = 0, time_s = 0;
  for (std::size_t k = 1; k < eye.time_s.size(); ++k) {
    const double at_s = eye.time_s[k];
    if (at_s < stretch.from_s + kOnsetS || at_s >= stretch.to_s ||
        std::any_of(saccades.begin(), saccades.end(),
                    [&](const Saccade& s) { return at_s >= s.onset_s - kAroundS && at_s < s.offset_s + kAroundS; })) {
      continue;
    }
    way_deg += ((eye.pan_deg[k] - eye.pan_deg[k - 1]) * stretch.velocity_deg_s[0] +
                (eye.tilt_deg[k] - eye.tilt_deg[k - 1]) * stretch.velocity_deg_s[1]) /
               speed_deg_s;
    time_s += at_s - eye.time_s[k - 1];
  }
  return time_s > 0 ? way_deg / time_s / speed_deg_s : 0;
}

void follow_ramp(const MovementTrial& trial, const std::vector<Saccade>& saccades, const Stretch& stretch,
                 Followed& found) {
  const double speed_deg_s = std::hypot(stretch.velocity_deg_s[0], stretch.velocity_deg_s[1]);
  const AngleTrace& eye = trial.command[0];
  const auto along = [&](double from_s, double to_s) {
    return (mean_between(eye, eye.pan_deg, from_s, to_s) * stretch.velocity_deg_s[0] +
            mean_between(eye, eye.tilt_deg, from_s, to_s) * stretch.velocity_deg_s[1]) /
           speed_deg_s;
  };
  const double begin_s = stretch.from_s + kOnsetS;
  constexpr double kWindowS = 0.1;
  if (stretch.to_s - begin_s > 2 * kWindowS) {
    const double way_deg = along(stretch.to_s - kWindowS, stretch.to_s) - along(begin_s, begin_s + kWindowS);
    found.gain.push_back(way_deg / (stretch.to_s - begin_s - kWindowS) / speed_deg_s);
    found.smooth_gain.push_back(smooth_gain(trial, saccades, stretch, speed_deg_s));
  }
  const double rest_deg = along(stretch.from_s - 0.2, stretch.from_s);
  for (double at_s = stretch.from_s; at_s < stretch.to_s; at_s += 0.01) {
    if (std::abs(along(at_s, at_s + 0.02) - rest_deg) > 0.5) {
      found.latency_ms.push_back(1000 * (at_s - stretch.from_s));
      break;
    }
  }
}

/// Amplitude and phase of the eye at the target's frequency.
void follow_sinusoid(const MovementTrial& trial, const Stretch& stretch, double period_s, Followed& found) {
  const auto fundamental = [&](const AngleTrace& trace) {
    double in = 0, quadrature = 0;
    const double middle_deg = mean_between(trace, trace.pan_deg, stretch.from_s, stretch.to_s);
    for (std::size_t k = 0; k < trace.time_s.size(); ++k) {
      if (trace.time_s[k] >= stretch.from_s && trace.time_s[k] < stretch.to_s) {
        const double phase = 2 * std::numbers::pi * (trace.time_s[k] - stretch.from_s) / period_s;
        in += (trace.pan_deg[k] - middle_deg) * std::sin(phase);
        quadrature += (trace.pan_deg[k] - middle_deg) * std::cos(phase);
      }
    }
    return std::array<double, 2>{in, quadrature};
  };
  const std::array<double, 2> eye = fundamental(gaze_trace(trial.recording, Eye::Left));
  const std::array<double, 2> target = fundamental(target_trace(trial.recording, Eye::Left));
  found.gain.push_back(std::hypot(eye[0], eye[1]) / std::hypot(target[0], target[1]));
  const double lag =
      std::remainder(std::atan2(target[1], target[0]) - std::atan2(eye[1], eye[0]), 2 * std::numbers::pi);
  found.lag_ms.push_back(1000 * lag / (2 * std::numbers::pi) * period_s);
}

double rmse_deg(const Recording& recording) {
  const TrackingMetrics metrics = tracking_metrics(recording);
  double sum_deg = 0;
  for (std::size_t c = 0; c < kChannels; ++c) {
    sum_deg += channel_of(metrics, c).all.rmse_deg / static_cast<double>(kChannels);
  }
  return sum_deg;
}

struct PlanResult {
  Followed followed;
  std::array<std::vector<double>, kControllers> rmse_deg;
  std::optional<Chart> chart;
};

Chart excerpt(const MovementTrial& trial, const Plan& plan) {
  Chart chart;
  chart.description = "target and left eye over time, " + plan.what;
  const double to_s = std::min(plan.duration_s, plan.period_s > 0 ? kRestS + 3 * plan.period_s : 8.0);
  chart.x = {.label = "time (s)", .min = 0.0, .max = to_s};
  chart.y = {.label = "left eye pan (deg)", .min = {}, .max = {}};
  for (const auto& [trace, name, ink] : {std::tuple{target_trace(trial.recording, Eye::Left), "target", "target"},
                                         {gaze_trace(trial.recording, Eye::Left), "eye", "left"}}) {
    Series series{.kind = SeriesKind::Line, .name = name, .ink = ink, .x = {}, .y = {}};
    for (std::size_t k = 0; k < trace.time_s.size() && trace.time_s[k] <= to_s; ++k) {
      series.x.push_back(trace.time_s[k]);
      series.y.push_back(trace.pan_deg[k]);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

void run_plan(const SpikeImage& image, const Protocol& protocol, const Plan& plan, std::size_t trial, PlanResult& out,
              const std::function<void(double)>& report) {
  const Setting setting = settings_of(protocol).front();
  SimulatedRunOptions options = trial_options(image, protocol, setting, protocol.first_seed + trial);
  options.head.scenario.kind = ScenarioKind::Path;
  options.head.scenario.path = plan.path;
  options.duration_s = plan.duration_s;
  const PidGains pid = pid_gains(protocol, setting.camera_latency_frames);
  out.rmse_deg[1].push_back(rmse_deg(run_reference(image, options, {ReferenceKind::Oracle, {}})));
  out.rmse_deg[2].push_back(rmse_deg(run_reference(image, options, {ReferenceKind::Pid, pid})));
  const MovementTrial moved = run_movement(image, options, report);
  out.rmse_deg[0].push_back(rmse_deg(moved.recording));
  const std::vector<Saccade> saccades = saccades_of(moved.command[0], kCatchUpDegS);
  for (const Stretch& stretch : plan.stretches) {
    if (plan.period_s > 0) {
      follow_sinusoid(moved, stretch, plan.period_s, out.followed);
    } else {
      follow_ramp(moved, saccades, stretch, out.followed);
    }
    out.followed.watched_s += stretch.to_s - stretch.from_s;
    out.followed.catch_ups +=
        static_cast<double>(std::count_if(saccades.begin(), saccades.end(), [&](const Saccade& s) {
          return s.onset_s >= stretch.from_s && s.onset_s < stretch.to_s;
        }));
  }
  if (trial == 0) {
    out.chart = excerpt(moved, plan);
  }
}

MeasureRow row_of(const Plan& plan, const PlanResult& result) {
  const Followed& f = result.followed;
  const auto middle = [](const std::vector<double>& values) {
    return values.empty() ? std::nullopt : std::optional<double>(median(values));
  };
  MeasureRow row;
  row.what = plan.what;
  row.values = {middle(f.gain),
                middle(f.smooth_gain),
                middle(f.latency_ms),
                middle(f.lag_ms),
                f.watched_s > 0 ? std::optional<double>(f.catch_ups / f.watched_s) : std::nullopt,
                mean(result.rmse_deg[0]),
                mean(result.rmse_deg[1]),
                mean(result.rmse_deg[2])};
  return row;
}

}  // namespace

MeasuredProtocol measure_pursuit(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                 const std::function<void(double)>& progress) {
  std::vector<Plan> plans;
  for (const double speed_deg_s : protocol.movement.speeds_deg_s) {
    plans.push_back(ramps(speed_deg_s, protocol.wall_distance_m));
  }
  for (const double period_s : protocol.movement.periods_s) {
    plans.push_back(sinusoid(period_s, protocol.wall_distance_m));
  }
  std::vector<PlanResult> results(plans.size());
  std::vector<Job> jobs;
  for (std::size_t p = 0; p < plans.size(); ++p) {
    jobs.emplace_back([&, p](const std::function<void(double)>& report) {
      for (std::size_t trial = 0; trial < static_cast<std::size_t>(protocol.trials); ++trial) {
        run_plan(image, protocol, plans[p], trial, results[p], report);
      }
    });
  }
  run_jobs(jobs, threads, progress);
  MeasuredProtocol measures;
  MeasureTable table;
  table.title = "pursuit: step-ramps left, right, up and down; sinusoids of 10 deg to either side (medians; left eye)";
  table.columns = {{"gain", "", 2},         {"smooth gain", "", 2}, {"starts", "ms", 0},  {"lags", "ms", 0},
                   {"catch-ups", "1/s", 1}, {"RMSE", "deg", 2},     {"oracle", "deg", 2}, {"pid", "deg", 2}};
  for (std::size_t p = 0; p < plans.size(); ++p) {
    table.rows.push_back(row_of(plans[p], results[p]));
    if (results[p].chart) {
      measures.pictures.push_back({plans[p].what, "", *results[p].chart});
    }
  }
  table.notes = {
      "gain: eye over target speed, catch-up saccades and all; smooth gain: between the saccades; from 300 ms after a "
      "ramp begins",
      "people: gain 0.95 at 5 to 30 deg/s, first movement after 100 to 150 ms (Robinson 1986)"};
  measures.tables = {table};
  return measures;
}

}  // namespace tectum
