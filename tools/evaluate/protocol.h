// An evaluation as data: what the target does, how long and how often, and what the results are held against.
// The files are circuits/protocols/*.json; circuits/protocols/README.md says what each key means.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/head/sim_head.h"

namespace tectum {

/// goal = p e + i * sum(e dt) + d de/dt, e the retinal error of the newest frame.
struct PidGains {
  double p = 0;
  double i_hz = 0;
  double d_s = 0;
};

struct TunedPid {
  std::uint32_t camera_latency_frames = 0;
  PidGains gains;
};

/// The grid that `tectum eval --tune-pid` searches, on seeds that are not reported on.
struct PidTuning {
  std::uint64_t first_seed = 1000;
  int trials = 3;
  double duration_s = 60;
  double hold_s = 1;
  std::vector<double> p, i_hz, d_s;
};

/// A row of somebody else's table. Numbers that they do not give are absent.
struct PublishedRow {
  std::string what;
  std::optional<double> median_deg, rmse_deg, learned_median_deg, learned_rmse_deg;
};

/// How often, how late and how long: one of the protocol's combinations.
struct Setting {
  double hold_s = 0;  // between the jumps of a random target; 0: the target has no such thing
  std::uint32_t camera_latency_frames = 1;
};

/// How a circuit that learns is tried.
struct LearningPlan {
  std::vector<double> perturbed = {0};  // starts: weights onto each side of a population off by these
  double duration_s = 120;              // of the training before the trials of what was learned
  std::uint64_t first_seed = 2000;      // of the training
};

enum class ProtocolKind {
  Tracking,
  Physiology,
  Learning,
  Saccades,
  Pursuit,
  Vergence,
  Gaze,
  Fixation,
  Clinic,
  Robustness
};

/// What the dot does in the protocols that measure one kind of movement each (tools/evaluate/movements.h).
struct MovementSizes {
  std::vector<double> sizes_deg;     // saccades, gaze: how far
  std::vector<double> speeds_deg_s;  // pursuit: ramps
  std::vector<double> periods_s;     // pursuit: sinusoids
  std::vector<double> distances_m;   // vergence: of the screen that the dot jumps to from the wall
  std::vector<double> radii_m;       // fixation: of the dot
  double fovea_deg = 0;              // fixation: its radius, that dots are larger or smaller than; 0: not said
};

struct Protocol {
  std::string name;
  std::string about;
  ProtocolKind kind = ProtocolKind::Tracking;
  ScenarioParams scenario;
  MovementSizes movement;
  double wall_distance_m = 0.55;
  double servo_speed_deg_s = 0;  // 0: as fast as the servo can
  double frame_rate_hz = 45;
  int trials = 1;
  double duration_s = 60;
  std::uint64_t first_seed = 0;
  std::vector<double> hold_s = {1};
  std::vector<std::uint32_t> camera_latency_frames = {1};
  std::vector<TunedPid> pid;
  PidTuning tuning;
  LearningPlan learning;
  std::string published_by;
  std::vector<PublishedRow> published;
};

/// Hold and latency, every combination, latency outermost.
[[nodiscard]] std::vector<Setting> settings_of(const Protocol& protocol);

/// The gains tuned for this latency, or for the nearest one.
[[nodiscard]] PidGains pid_gains(const Protocol& protocol, std::uint32_t camera_latency_frames);

struct ReadProtocol {
  std::optional<Protocol> protocol;
  std::string error;     // one line when the file cannot be read; else empty
  std::string problems;  // what is wrong in it, as text for people
};
[[nodiscard]] ReadProtocol read_protocol_file(const std::string& path);
/// `bytes` as if they were the file `name`.
[[nodiscard]] ReadProtocol read_protocol_text(const std::string& name, const std::string& bytes);

}  // namespace tectum
