#include "tools/circuit_tests/measures.h"

#include <algorithm>
#include <cmath>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/spike_times.h"
#include "tools/analysis/statistics.h"
#include "tools/evaluate/eye_plant.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {
namespace {

constexpr double kMsPerS = 1000;
constexpr double kSmallestSaccadeDeg = 1;
constexpr double kRestAroundSaccadeS = 0.1;

using Pick = double (*)(const AxisMetrics& axis);

/// Of one channel, or the mean over the four, as `tectum eval` reports.
template <double (*pick)(const AxisMetrics&)>
std::optional<double> tracking(RunFacts& facts, const std::optional<std::size_t>& channel) {
  const TrackingMetrics& metrics = facts.tracking();
  if (!metrics.has_truth) {
    return std::nullopt;
  }
  if (channel) {
    return pick(channel_of(metrics, *channel));
  }
  double sum = 0;
  for (std::size_t c = 0; c < kChannels; ++c) {
    sum += pick(channel_of(metrics, c)) / static_cast<double>(kChannels);
  }
  return sum;
}

double rmse(const AxisMetrics& axis) { return axis.all.rmse_deg; }
double settled_rmse(const AxisMetrics& axis) { return axis.settled.rmse_deg; }
double median_error(const AxisMetrics& axis) { return axis.all.median_abs_deg; }
double bias(const AxisMetrics& axis) { return axis.all.median_deg; }
double on_fovea(const AxisMetrics& axis) { return axis.all.fovea_share; }
double jitter(const AxisMetrics& axis) { return axis.jitter_deg; }

template <double (*pick)(const RunFacts::JumpSaccade&)>
std::optional<double> over_saccades(RunFacts& facts, const std::optional<std::size_t>&) {
  std::vector<double> values;
  for (const RunFacts::JumpSaccade& each : facts.first_saccades()) {
    values.push_back(pick(each));
  }
  return values.empty() ? std::nullopt : std::optional(median(values));
}

double latency_ms(const RunFacts::JumpSaccade& s) { return kMsPerS * s.latency_s; }
double amplitude_deg(const RunFacts::JumpSaccade& s) { return s.saccade.amplitude_deg; }
double peak_deg_ms(const RunFacts::JumpSaccade& s) { return s.saccade.peak_velocity_deg_s / kMsPerS; }
double duration_ms(const RunFacts::JumpSaccade& s) { return kMsPerS * s.saccade.duration_s; }
double landing_error_deg(const RunFacts::JumpSaccade& s) { return s.landing_error_deg; }

template <double (*pick)(const StepResponse&)>
std::optional<double> over_steps(RunFacts& facts, const std::optional<std::size_t>&) {
  std::vector<double> values;
  for (const StepResponse& step : facts.steps()) {
    values.push_back(pick(step));
  }
  return values.empty() ? std::nullopt : std::optional(median(values));
}

double overshoot(const StepResponse& step) { return step.overshoot_share; }
double settled_ms(const StepResponse& step) { return kMsPerS * step.settled_s; }

std::optional<double> saccades_per_jump(RunFacts& facts, const std::optional<std::size_t>&) {
  return facts.saccades_per_jump();
}
std::optional<double> eye_travel(RunFacts& facts, const std::optional<std::size_t>&) { return facts.eye_travel_deg(); }

/// Linear between samples; the ends beyond them.
double sample_at(const std::vector<double>& time_s, const std::vector<double>& value, double at_s) {
  const auto after = std::upper_bound(time_s.begin(), time_s.end(), at_s);
  const auto index = static_cast<std::size_t>(after - time_s.begin());
  return value[index == 0 ? 0 : index - 1];
}

}  // namespace

const std::vector<Measure>& measures() {
  static const std::vector<Measure> kMeasures = {
      {"", "rmse", kAngle, false, true, "root mean square error of the eyes, every frame", tracking<rmse>},
      {"", "settled_rmse", kAngle, false, true, "the same without the 300 ms after each jump of the target",
       tracking<settled_rmse>},
      {"", "median_error", kAngle, false, true, "median of the error's size", tracking<median_error>},
      {"", "bias", kAngle, false, true, "median of the signed error", tracking<bias>},
      {"", "on_fovea", kNumber, true, true, "share of frames with less than 1 deg of error", tracking<on_fovea>},
      {"", "jitter", kAngle, false, true, "peak to peak within a hold of the target", tracking<jitter>},
      {"", "eye_travel", kAngle, false, false, "farthest that an eye joint is told to go", eye_travel},
      {"saccade", "latency", kTime, false, false, "from the jump of the target to the eye's first saccade",
       over_saccades<latency_ms>},
      {"saccade", "amplitude", kAngle, false, false, "of the first saccade after a jump", over_saccades<amplitude_deg>},
      {"saccade", "peak_velocity", kAngularVelocity, false, false, "of the first saccade", over_saccades<peak_deg_ms>},
      {"saccade", "duration", kTime, false, false, "of the first saccade", over_saccades<duration_ms>},
      {"saccade", "landing_error", kAngle, false, false, "from the first saccade's end to the target",
       over_saccades<landing_error_deg>},
      {"saccade", "overshoot", kNumber, true, false, "farthest point beyond the target, over the jump",
       over_steps<overshoot>},
      {"saccade", "settling", kTime, false, false, "until the eye stays within 2 deg", over_steps<settled_ms>},
      {"saccade", "per_jump", kNumber, false, false, "saccades for one jump of the target", saccades_per_jump},
  };
  return kMeasures;
}

const TrackingMetrics& RunFacts::tracking() {
  if (!tracking_) {
    tracking_ = tracking_metrics(recording_);
  }
  return *tracking_;
}

const TrialColumns& RunFacts::columns() {
  if (!columns_) {
    columns_ = trial_columns(image_, recording_);
  }
  return *columns_;
}

const std::vector<StepResponse>& RunFacts::steps() {
  if (!steps_) {
    steps_.emplace();
    for (const Eye eye : {Eye::Left, Eye::Right}) {
      const std::vector<StepResponse> of_eye =
          step_responses(gaze_trace(recording_, eye), target_trace(recording_, eye), target_jump_times_s(recording_));
      steps_->insert(steps_->end(), of_eye.begin(), of_eye.end());
    }
  }
  return *steps_;
}

void RunFacts::find_saccades() {
  saccades_.emplace();
  const std::vector<double> jumps_s = target_jump_times_s(recording_);
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    SaccadeOptions options;
    options.min_amplitude_deg = kSmallestSaccadeDeg;
    const std::vector<Saccade> found = detect_saccades(sampled_gaze_trace(recording_, eye), options);
    const AngleTrace target = target_trace(recording_, eye);
    for (std::size_t j = 0; j < jumps_s.size(); ++j) {
      const double end_s = j + 1 < jumps_s.size() ? jumps_s[j + 1] : recording_.duration_s;
      bool is_first = true;
      for (const Saccade& saccade : found) {
        if (saccade.onset_s < jumps_s[j] || saccade.onset_s >= end_s) {
          continue;
        }
        if (is_first) {
          const double pan_deg = sample_at(target.time_s, target.pan_deg, saccade.offset_s) - saccade.to_deg[0];
          const double tilt_deg = sample_at(target.time_s, target.tilt_deg, saccade.offset_s) - saccade.to_deg[1];
          saccades_->push_back({saccade, saccade.onset_s - jumps_s[j], std::hypot(pan_deg, tilt_deg)});
        }
        is_first = false;
        ++saccade_count_;
      }
      ++jump_count_;
    }
  }
}

const std::vector<RunFacts::JumpSaccade>& RunFacts::first_saccades() {
  if (!saccades_) {
    find_saccades();
  }
  return *saccades_;
}

std::optional<double> RunFacts::saccades_per_jump() {
  (void)first_saccades();
  return jump_count_ == 0 ? std::nullopt
                          : std::optional(static_cast<double>(saccade_count_) / static_cast<double>(jump_count_));
}

namespace {

/// The times [begin, end) that the rate is taken over.
std::vector<TimeRange> times_of(RateTime time, RunFacts& facts) {
  const double end_s = facts.recording().duration_s;
  if (time == RateTime::WholeRun) {
    return {{facts.settle_s(), end_s}};
  }
  std::vector<TimeRange> times;
  double rest_from_s = facts.settle_s();
  for (const Saccade& saccade : facts.columns().saccades) {
    if (time == RateTime::Saccades) {
      // The eye goes on after the burst for as long as its plant lags.
      times.push_back({saccade.onset_s, saccade.offset_s - kEyePlantLagS});
    } else {
      times.push_back({rest_from_s, saccade.onset_s - kRestAroundSaccadeS});
    }
    rest_from_s = saccade.offset_s + kRestAroundSaccadeS;
  }
  if (time == RateTime::Fixation) {
    times.push_back({rest_from_s, end_s});
  }
  std::erase_if(times, [](const TimeRange& range) { return range.end_s <= range.begin_s; });
  return times;
}

}  // namespace

std::optional<double> RunFacts::rate_hz(const std::vector<std::size_t>& populations, RateTime time) {
  const std::vector<std::uint32_t> population_of = population_of_neurons(recording_);
  double spikes = 0, time_s = 0;
  for (const TimeRange& range : times_of(time, *this)) {
    for (const RecordedSpike& spike : spikes_between(recording_, range.begin_s, range.end_s)) {
      spikes += std::count(populations.begin(), populations.end(), population_of[spike.neuron]) > 0 ? 1 : 0;
    }
    time_s += range.end_s - range.begin_s;
  }
  std::size_t neurons = 0;
  for (const std::size_t population : populations) {
    neurons += recording_.populations[population].size;
  }
  return time_s <= 0 || neurons == 0 ? std::nullopt : std::optional(spikes / (time_s * static_cast<double>(neurons)));
}

double RunFacts::eye_travel_deg() const {
  const auto is_settled = [&](const RecordedFrame& frame) {
    return static_cast<double>(frame.time_ns) * 1e-9 >= settle_s_;
  };
  const auto first = std::find_if(recording_.frames.begin(), recording_.frames.end(), is_settled);
  double most_deg = 0;
  for (auto frame = first; frame != recording_.frames.end(); ++frame) {
    for (const Joint joint : {Joint::LeftEyePan, Joint::LeftEyeTilt, Joint::RightEyePan, Joint::RightEyeTilt}) {
      const auto j = static_cast<std::size_t>(joint);
      most_deg = std::max(most_deg, std::abs(frame->goal_deg[j] - first->goal_deg[j]));
    }
  }
  return most_deg;
}

std::vector<std::size_t> populations_named(const std::vector<std::string>& names, const std::string& name) {
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (names[p] == name || names[p].starts_with(name + ".")) {
      found.push_back(p);
    }
  }
  return found;
}

}  // namespace tectum
