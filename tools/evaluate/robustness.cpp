#include "tools/evaluate/robustness.h"

#include <atomic>
#include <cmath>

#include "tools/analysis/tracking_metrics.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/evaluate/reference_run.h"

namespace tectum {
namespace {

using Report = std::function<void(double)>;

double rmse_of(const Recording& recording) {
  const TrackingMetrics metrics = tracking_metrics(recording);
  double sum_deg = 0;
  for (std::size_t c = 0; c < kChannels; ++c) {
    sum_deg += channel_of(metrics, c).all.rmse_deg;
  }
  return sum_deg / static_cast<double>(kChannels);
}

double circuit_rmse_deg(const SpikeImage& image, const SimulatedRunOptions& options, const Report& report) {
  RunObserver observer;
  observer.progress = report;
  return rmse_of(run_simulated_head(image, options, observer));
}

/// One trial at one level: what the jobs run.
class Trials {
 public:
  Trials(const SpikeImage& image, const Protocol& protocol, const LesionedImage& lesioned)
      : image_(image), protocol_(protocol), lesioned_(lesioned), setting_(settings_of(protocol).front()) {}

  void undisturbed(DisturbedRmse& out, std::size_t trial, const Report& report) const {
    const SimulatedRunOptions options = options_of(trial);
    references(out, trial, options);
    out.circuit_deg[trial] = circuit_rmse_deg(image_, options, report);
  }

  /// False when the circuit could not be compiled.
  bool disturbed(Disturbance disturbance, DisturbedRmse& out, std::size_t trial, const Report& report) const {
    SimulatedRunOptions options = options_of(trial);
    disturb_head(disturbance, out.level, options.head);
    if (!facts_of(disturbance).is_of_the_circuit) {
      references(out, trial, options);
      out.circuit_deg[trial] = circuit_rmse_deg(image_, options, report);
      return true;
    }
    const std::uint64_t seed = protocol_.first_seed + trial;
    const std::optional<SpikeImage> changed =
        disturbance == Disturbance::WeightNoise    ? with_weight_noise(image_, out.level, seed)
        : disturbance == Disturbance::PathwayNoise ? with_pathway_noise(image_, out.level, seed)
                                                   : lesioned_(disturbance, out.level, seed);
    if (changed) {
      out.circuit_deg[trial] = circuit_rmse_deg(*changed, options, report);
    }
    return changed.has_value();
  }

 private:
  [[nodiscard]] SimulatedRunOptions options_of(std::size_t trial) const {
    return trial_options(image_, protocol_, setting_, protocol_.first_seed + trial);
  }

  void references(DisturbedRmse& out, std::size_t trial, const SimulatedRunOptions& options) const {
    const PidGains gains = pid_gains(protocol_, setting_.camera_latency_frames);
    out.pid_deg[trial] = rmse_of(run_reference(image_, options, {ReferenceKind::PidFromPicture, gains}));
    out.oracle_deg[trial] = rmse_of(run_reference(image_, options, {ReferenceKind::Oracle, {}}));
  }

  const SpikeImage& image_;
  const Protocol& protocol_;
  const LesionedImage& lesioned_;
  Setting setting_;
};

DisturbedRmse empty_level(double level, std::size_t trials, bool has_references) {
  DisturbedRmse out;
  out.level = level;
  out.circuit_deg.resize(trials);
  out.pid_deg.resize(has_references ? trials : 0);
  out.oracle_deg.resize(has_references ? trials : 0);
  return out;
}

}  // namespace

void disturb_head(Disturbance disturbance, double level, SimHeadParams& head) {
  switch (disturbance) {
    case Disturbance::SensorNoise:
      head.camera.noise_sigma = level;
      break;
    case Disturbance::DroppedFrames:
      head.dropped_share = level;
      break;
    case Disturbance::DotBrightness:
      head.camera.dot_brightness = level;
      break;
    case Disturbance::RoomBrightness:
      head.camera.wall_brightness = level;
      break;
    case Disturbance::DeadFields:
    case Disturbance::LostNeurons:
    case Disturbance::WeightNoise:
    case Disturbance::PathwayNoise:
      break;
  }
}

std::optional<RobustnessResult> evaluate_robustness(const SpikeImage& image, const Protocol& protocol,
                                                    const RobustnessPlan& plan, const LesionedImage& lesioned,
                                                    unsigned threads, const std::function<void(double)>& progress) {
  const auto trial_count = static_cast<std::size_t>(protocol.trials);
  const Trials trials(image, protocol, lesioned);
  RobustnessResult result;
  result.undisturbed = empty_level(0, trial_count, true);
  std::atomic<bool> is_ok = true;
  std::vector<Job> jobs;
  for (std::size_t trial = 0; trial < trial_count; ++trial) {
    jobs.emplace_back([&, trial](const Report& report) { trials.undisturbed(result.undisturbed, trial, report); });
  }
  for (std::size_t d = 0; d < kDisturbances; ++d) {
    const auto disturbance = static_cast<Disturbance>(d);
    for (const double level : plan.of(disturbance)) {
      result.levels[d].push_back(empty_level(level, trial_count, !facts_of(disturbance).is_of_the_circuit));
    }
    for (DisturbedRmse& out : result.levels[d]) {
      for (std::size_t trial = 0; trial < trial_count; ++trial) {
        jobs.emplace_back([&, disturbance, trial](const Report& report) {
          if (!trials.disturbed(disturbance, out, trial, report)) {
            is_ok = false;
          }
        });
      }
    }
  }
  run_jobs(jobs, threads, progress);
  return is_ok ? std::optional(std::move(result)) : std::nullopt;
}

}  // namespace tectum
