// Trials of a tracking protocol: the circuit, the oracle and the PID servo on the same targets and servos.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tools/analysis/simulated_run.h"
#include "tools/analysis/tracking_metrics.h"
#include "tools/evaluate/protocol.h"
#include "tools/evaluate/step_response.h"

namespace tectum {

enum class Controller { Circuit, Oracle, Pid };
inline constexpr std::size_t kControllers = 3;
inline constexpr std::array<const char*, kControllers> kControllerNames = {"circuit", "oracle", "pid"};

/// Left horizontal, left vertical, right horizontal, right vertical: the rows of the paper's Table I.
inline constexpr std::size_t kChannels = 4;
inline constexpr std::array<const char*, kChannels> kChannelNames = {"left horizontal", "left vertical",
                                                                     "right horizontal", "right vertical"};

struct TrialResult {
  TrackingMetrics metrics;
  StepSummary steps;  // of both eyes
};
[[nodiscard]] const AxisMetrics& channel_of(const TrackingMetrics& metrics, std::size_t channel);

/// Means over the trials of a channel, or of all four.
struct ChannelSummary {
  double median_deg = 0;      // signed
  double median_abs_deg = 0;  // of the trials' medians of |error|
  double rmse_deg = 0, rmse_sd_deg = 0;
  double settled_rmse_deg = 0;
  double p90_abs_deg = 0;
  double fovea_share = 0;
  double jitter_deg = 0;
  double wall_median_deg = 0, wall_rmse_deg = 0;  // the paper's definition
};

struct ControllerResult {
  std::vector<TrialResult> trials;  // in the order of the seeds
  std::array<ChannelSummary, kChannels> channels{};
  ChannelSummary all;  // means over the four channels
  StepSummary steps;   // medians of the trials' medians
  double neck_travel_deg = 0;
  Recording first_trial;  // frames only, for pictures
};

struct SettingResult {
  Setting setting;
  PidGains pid;
  std::array<ControllerResult, kControllers> controllers;
  [[nodiscard]] const ControllerResult& of(Controller controller) const {
    return controllers[static_cast<std::size_t>(controller)];
  }
};

struct TrackingEvaluation {
  std::vector<SettingResult> settings;
};

/// The simulated head of one trial of a protocol.
[[nodiscard]] SimulatedRunOptions trial_options(const SpikeImage& image, const Protocol& protocol,
                                                const Setting& setting, std::uint64_t seed);

/// The circuit alone, in one trial.
[[nodiscard]] TrialResult run_circuit_trial(const SpikeImage& image, const Protocol& protocol, const Setting& setting,
                                            std::uint64_t seed, const std::function<void(double)>& progress);

/// Deterministic in image and protocol, whatever the number of threads (0: one for each core).
[[nodiscard]] TrackingEvaluation evaluate_tracking(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                   const std::function<void(double)>& progress);

/// Tries every point of the protocol's grid for each latency on the tuning seeds, and returns the one with the least
/// mean RMSE; on a tie the first.
struct PidTuningResult {
  TunedPid tuned;
  double rmse_deg = 0;
  double oracle_rmse_deg = 0;  // on the same trials
  std::size_t tried = 0;
};
[[nodiscard]] std::vector<PidTuningResult> tune_pid(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                    const std::function<void(double)>& progress);

}  // namespace tectum
