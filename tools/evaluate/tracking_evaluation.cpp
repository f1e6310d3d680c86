#include "tools/evaluate/tracking_evaluation.h"

#include <algorithm>
#include <cmath>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/statistics.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/evaluate/reference_run.h"
#include "tools/evaluate/trial_result.h"

namespace tectum {
namespace {

double standard_deviation(const std::vector<double>& sample) {
  if (sample.size() < 2) {
    return 0;
  }
  const double middle = mean(sample);
  double sum = 0;
  for (const double value : sample) {
    sum += (value - middle) * (value - middle);
  }
  return std::sqrt(sum / static_cast<double>(sample.size() - 1));
}

template <typename Pick>
std::vector<double> over_trials(const std::vector<TrialResult>& trials, const Pick& pick) {
  std::vector<double> values;
  for (const TrialResult& trial : trials) {
    values.push_back(pick(trial));
  }
  return values;
}

ChannelSummary channel_summary(const std::vector<TrialResult>& trials, std::size_t channel) {
  const auto average = [&](const auto& pick) {
    return mean(over_trials(trials, [&](const TrialResult& t) { return pick(channel_of(t.metrics, channel)); }));
  };
  ChannelSummary s;
  s.median_deg = average([](const AxisMetrics& a) { return a.all.median_deg; });
  s.median_abs_deg = average([](const AxisMetrics& a) { return a.all.median_abs_deg; });
  s.settled_rmse_deg = average([](const AxisMetrics& a) { return a.settled.rmse_deg; });
  s.p90_abs_deg = average([](const AxisMetrics& a) { return a.all.p90_abs_deg; });
  s.fovea_share = average([](const AxisMetrics& a) { return a.all.fovea_share; });
  s.jitter_deg = average([](const AxisMetrics& a) { return a.jitter_deg; });
  s.wall_median_deg = average([](const AxisMetrics& a) { return a.wall.median_deg; });
  s.wall_rmse_deg = average([](const AxisMetrics& a) { return a.wall.rmse_deg; });
  const std::vector<double> rmse_deg =
      over_trials(trials, [&](const TrialResult& t) { return channel_of(t.metrics, channel).all.rmse_deg; });
  s.rmse_deg = mean(rmse_deg);
  s.rmse_sd_deg = standard_deviation(rmse_deg);
  return s;
}

ChannelSummary mean_of(const std::array<ChannelSummary, kChannels>& channels, const std::vector<TrialResult>& trials) {
  ChannelSummary sum;
  for (const ChannelSummary& each : channels) {
    const double share = 1.0 / static_cast<double>(kChannels);
    sum.median_deg += share * each.median_deg;
    sum.median_abs_deg += share * each.median_abs_deg;
    sum.rmse_deg += share * each.rmse_deg;
    sum.settled_rmse_deg += share * each.settled_rmse_deg;
    sum.p90_abs_deg += share * each.p90_abs_deg;
    sum.fovea_share += share * each.fovea_share;
    sum.jitter_deg += share * each.jitter_deg;
    sum.wall_median_deg += share * each.wall_median_deg;
    sum.wall_rmse_deg += share * each.wall_rmse_deg;
  }
  sum.rmse_sd_deg = standard_deviation(over_trials(trials, [](const TrialResult& t) {
    double rmse_deg = 0;
    for (std::size_t c = 0; c < kChannels; ++c) {
      rmse_deg += channel_of(t.metrics, c).all.rmse_deg / static_cast<double>(kChannels);
    }
    return rmse_deg;
  }));
  return sum;
}

Recording without_details(Recording recording) {
  recording.spikes.clear();
  for (RecordedFrame& frame : recording.frames) {
    frame.active_fields = {};
  }
  return recording;
}

Recording run_controller(const SpikeImage& image, const SimulatedRunOptions& options, Controller controller,
                         const PidGains& pid, const std::function<void(double)>& progress) {
  switch (controller) {
    case Controller::Oracle:
      return run_reference(image, options, {.kind = ReferenceKind::Oracle, .pid = {}});
    case Controller::Pid:
      return run_reference(image, options, {.kind = ReferenceKind::Pid, .pid = pid});
    case Controller::Circuit:
      break;
  }
  RunObserver observer;
  observer.progress = progress;
  return run_simulated_head(image, options, observer);
}

double mean_rmse_deg(const Recording& recording) {
  const TrackingMetrics metrics = tracking_metrics(recording);
  double sum_deg = 0;
  for (std::size_t c = 0; c < kChannels; ++c) {
    sum_deg += channel_of(metrics, c).all.rmse_deg;
  }
  return sum_deg / static_cast<double>(kChannels);
}

std::vector<PidGains> grid_of(const PidTuning& tuning) {
  std::vector<PidGains> grid;
  for (const double p : tuning.p) {
    for (const double i_hz : tuning.i_hz) {
      for (const double d_s : tuning.d_s) {
        grid.push_back({p, i_hz, d_s});
      }
    }
  }
  return grid;
}

}  // namespace

TrialResult trial_result(const Recording& recording) {
  TrialResult trial;
  trial.metrics = tracking_metrics(recording);
  std::vector<StepResponse> steps;
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const std::vector<StepResponse> of_eye =
        step_responses(gaze_trace(recording, eye), target_trace(recording, eye), trial.metrics.target_jumps_s);
    steps.insert(steps.end(), of_eye.begin(), of_eye.end());
  }
  trial.steps = summarize_steps(steps);
  return trial;
}

void summarize(ControllerResult& result) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    result.channels[c] = channel_summary(result.trials, c);
  }
  result.all = mean_of(result.channels, result.trials);
  const auto middle = [&](double StepSummary::*field) {
    return median(over_trials(result.trials, [field](const TrialResult& t) { return t.steps.*field; }));
  };
  for (const TrialResult& trial : result.trials) {
    result.steps.steps += trial.steps.steps;
    result.steps.settled += trial.steps.settled;
  }
  result.steps.median_latency_s = middle(&StepSummary::median_latency_s);
  result.steps.median_overshoot_share = middle(&StepSummary::median_overshoot_share);
  result.steps.p90_overshoot_share = middle(&StepSummary::p90_overshoot_share);
  result.steps.median_settled_s = middle(&StepSummary::median_settled_s);
  result.steps.p90_settled_s = middle(&StepSummary::p90_settled_s);
  result.neck_travel_deg = mean(over_trials(result.trials, [](const TrialResult& t) {
    return t.metrics.neck_pan_travel_deg + t.metrics.neck_tilt_travel_deg;
  }));
}

const AxisMetrics& channel_of(const TrackingMetrics& metrics, std::size_t channel) {
  const EyeMetrics& eye = metrics.eye[channel / 2];
  return channel % 2 == 0 ? eye.pan : eye.tilt;
}

SimulatedRunOptions trial_options(const SpikeImage& image, const Protocol& protocol, const Setting& setting,
                                  std::uint64_t seed) {
  SimulatedRunOptions options;
  options.head = fitted_to(image, options.head);
  options.head.seed = seed;
  options.head.scenario = protocol.scenario;
  if (setting.hold_s > 0) {
    options.head.scenario.random_hold_s = setting.hold_s;
  }
  options.head.geometry.wall_distance_m = protocol.wall_distance_m;
  options.head.servo.moving_speed_deg_s = protocol.servo_speed_deg_s;
  options.head.frame_period_ns = static_cast<TimeNs>(std::llround(1e9 / protocol.frame_rate_hz));
  options.head.camera_latency_frames = setting.camera_latency_frames;
  options.head.camera.width_px = 320;
  options.head.camera.height_px = 320;
  options.duration_s = protocol.duration_s;
  options.keeps_spikes = false;
  options.engine.threads = 1;  // trials run side by side instead
  return options;
}

TrialResult run_circuit_trial(const SpikeImage& image, const Protocol& protocol, const Setting& setting,
                              std::uint64_t seed, const std::function<void(double)>& progress) {
  return trial_result(
      run_controller(image, trial_options(image, protocol, setting, seed), Controller::Circuit, {}, progress));
}

TrackingEvaluation evaluate_tracking(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                     const std::function<void(double)>& progress) {
  TrackingEvaluation evaluation;
  for (const Setting& setting : settings_of(protocol)) {
    SettingResult result;
    result.setting = setting;
    result.pid = pid_gains(protocol, setting.camera_latency_frames);
    for (ControllerResult& controller : result.controllers) {
      controller.trials.resize(static_cast<std::size_t>(protocol.trials));
    }
    evaluation.settings.push_back(std::move(result));
  }
  std::vector<Job> jobs;
  for (SettingResult& result : evaluation.settings) {
    for (std::size_t trial = 0; trial < static_cast<std::size_t>(protocol.trials); ++trial) {
      jobs.emplace_back([&image, &protocol, &result, trial](const std::function<void(double)>& report) {
        const SimulatedRunOptions options = trial_options(image, protocol, result.setting, protocol.first_seed + trial);
        for (const Controller controller : {Controller::Oracle, Controller::Pid, Controller::Circuit}) {
          Recording recording = run_controller(image, options, controller, result.pid, report);
          ControllerResult& mine = result.controllers[static_cast<std::size_t>(controller)];
          mine.trials[trial] = trial_result(recording);
          if (trial == 0) {
            mine.first_trial = without_details(std::move(recording));
          }
        }
      });
    }
  }
  run_jobs(jobs, threads, progress);
  for (SettingResult& result : evaluation.settings) {
    std::for_each(result.controllers.begin(), result.controllers.end(), summarize);
  }
  return evaluation;
}

std::vector<PidTuningResult> tune_pid(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                      const std::function<void(double)>& progress) {
  const std::vector<PidGains> grid = grid_of(protocol.tuning);
  const auto trials = static_cast<std::size_t>(protocol.tuning.trials);
  Protocol on_tuning_seeds = protocol;
  on_tuning_seeds.duration_s = protocol.tuning.duration_s;
  const std::size_t latencies = protocol.camera_latency_frames.size();
  // One row a latency: the oracle's mean, then the grid's.
  std::vector<std::vector<double>> rmse_deg(latencies, std::vector<double>(grid.size() + 1, 0.0));
  std::vector<Job> jobs;
  for (std::size_t l = 0; l < latencies; ++l) {
    for (std::size_t g = 0; g <= grid.size(); ++g) {
      jobs.emplace_back([&, l, g](const std::function<void(double)>&) {
        const ReferenceController controller = g == 0 ? ReferenceController{ReferenceKind::Oracle, {}}
                                                      : ReferenceController{ReferenceKind::Pid, grid[g - 1]};
        const Setting setting{protocol.tuning.hold_s, protocol.camera_latency_frames[l]};
        for (std::size_t trial = 0; trial < trials; ++trial) {
          const SimulatedRunOptions options =
              trial_options(image, on_tuning_seeds, setting, protocol.tuning.first_seed + trial);
          rmse_deg[l][g] += mean_rmse_deg(run_reference(image, options, controller)) / static_cast<double>(trials);
        }
      });
    }
  }
  run_jobs(jobs, threads, progress);
  std::vector<PidTuningResult> results;
  for (std::size_t l = 0; l < latencies; ++l) {
    if (grid.empty()) {
      continue;
    }
    const auto best = std::min_element(rmse_deg[l].begin() + 1, rmse_deg[l].end());
    const auto index = static_cast<std::size_t>(best - rmse_deg[l].begin()) - 1;
    results.push_back({.tuned = {protocol.camera_latency_frames[l], grid[index]},
                       .rmse_deg = *best,
                       .oracle_rmse_deg = rmse_deg[l][0],
                       .tried = grid.size()});
  }
  return results;
}

}  // namespace tectum
