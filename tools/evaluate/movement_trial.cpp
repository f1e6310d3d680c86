#include "tools/evaluate/movement_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/act/decoder.h"

namespace tectum {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr std::array<std::array<Joint, 2>, kEyeCount> kEyeJoints = {
    {{Joint::LeftEyePan, Joint::LeftEyeTilt}, {Joint::RightEyePan, Joint::RightEyeTilt}}};

std::array<AngleTrace, kEyeCount> command_of(const SpikeImage& image, const Recording& recording) {
  std::array<AngleTrace, kEyeCount> traces;
  const double tick_s = static_cast<double>(recording.tick_ns) * 1e-9;
  const auto ticks_each = static_cast<std::uint64_t>(std::max(1.0, std::round(kMovementSampleS / tick_s)));
  const auto samples = static_cast<std::size_t>(recording.duration_s / kMovementSampleS);
  Decoder decoder(image);
  std::vector<NeuronId> now;
  std::size_t next = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    for (std::uint64_t tick = k * ticks_each; tick < (k + 1) * ticks_each; ++tick) {
      now.clear();
      for (; next < recording.spikes.size() && recording.spikes[next].tick == tick; ++next) {
        now.push_back(NeuronId{recording.spikes[next].neuron});
      }
      decoder.tick(now);
    }
    std::array<double, kJointCount> joint_deg{};
    decoder.decode(joint_deg);
    for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
      traces[eye].time_s.push_back(static_cast<double>(k) * kMovementSampleS);
      traces[eye].pan_deg.push_back(joint_deg[static_cast<std::size_t>(kEyeJoints[eye][0])]);
      traces[eye].tilt_deg.push_back(joint_deg[static_cast<std::size_t>(kEyeJoints[eye][1])]);
    }
  }
  return traces;
}

/// Gaps in which no neuron of population OPN fires, longer than any among neurons that fire at 100 Hz each.
std::vector<Pause> opn_pauses(const Recording& recording) {
  constexpr double kShortestS = 0.01;
  std::vector<Pause> pauses;
  const auto opn = std::find_if(recording.populations.begin(), recording.populations.end(),
                                [](const RecordedPopulation& population) { return population.name == "OPN"; });
  if (opn == recording.populations.end()) {
    return pauses;
  }
  const double tick_s = static_cast<double>(recording.tick_ns) * 1e-9;
  double last_s = -1;
  for (const RecordedSpike& spike : recording.spikes) {
    if (spike.neuron >= opn->first_neuron && spike.neuron < opn->first_neuron + opn->size) {
      const double at_s = static_cast<double>(spike.tick) * tick_s;
      if (last_s >= 0 && at_s - last_s > kShortestS) {
        pauses.push_back({last_s, at_s});
      }
      last_s = at_s;
    }
  }
  return pauses;
}

}  // namespace

MovementTrial run_movement(const SpikeImage& image, const SimulatedRunOptions& options,
                           const std::function<void(double)>& progress) {
  SimulatedRunOptions fine = options;
  fine.keeps_spikes = true;
  fine.sample_rate_hz = 1 / kMovementSampleS;
  RunObserver observer;
  observer.progress = progress;
  MovementTrial trial;
  trial.recording = run_simulated_head(image, fine, observer);
  trial.command = command_of(image, trial.recording);
  trial.eye = eye_movements(image, trial.recording);
  trial.opn_pauses = opn_pauses(trial.recording);
  for (const RecordedPositions& sample : trial.recording.positions) {
    for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
      trial.plant[eye].time_s.push_back(static_cast<double>(sample.time_ns) * 1e-9);
      trial.plant[eye].pan_deg.push_back(sample.position_deg[static_cast<std::size_t>(kEyeJoints[eye][0])]);
      trial.plant[eye].tilt_deg.push_back(sample.position_deg[static_cast<std::size_t>(kEyeJoints[eye][1])]);
    }
  }
  trial.recording.spikes = {};
  trial.recording.positions = {};
  return trial;
}

std::array<double, 2> place_m(double pan_deg, double tilt_deg, double distance_m) {
  const double right_m = distance_m * std::tan(pan_deg * kRadPerDeg);
  return {right_m, std::hypot(distance_m, right_m) * std::tan(tilt_deg * kRadPerDeg)};
}

double mean_between(const AngleTrace& trace, const std::vector<double>& values, double from_s, double to_s) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < trace.time_s.size(); ++k) {
    if (trace.time_s[k] >= from_s && trace.time_s[k] < to_s) {
      sum += values[k];
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

std::vector<Saccade> saccades_of(const AngleTrace& trace, double threshold_deg_s) {
  SaccadeOptions options;
  options.lambda = 0;  // a target that moves for a share of the time makes the median speed no measure of noise
  options.min_threshold_deg_s = threshold_deg_s;
  options.min_amplitude_deg = 1;
  return detect_saccades(trace, options);
}

}  // namespace tectum
