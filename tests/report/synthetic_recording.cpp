#include "tests/report/synthetic_recording.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace tectum {
namespace {

constexpr double kRateHz = 45;
constexpr double kWallM = 0.55;
constexpr double kEyeOffsetM = 0.0825;
constexpr double kDegPerRad = 180 / std::numbers::pi;
constexpr std::uint64_t kTickNs = 100'000;

struct World {
  std::mt19937 generator;
  std::array<double, 2> target_m{};
  std::array<std::array<double, 2>, 2> gaze_deg{};  // eye, axis
  std::array<double, 2> neck_deg{};
  double next_jump_s = 0.5;
  double saccade_at_s = 1e9;

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator); }
  double normal(double sd) { return std::normal_distribution<double>(0, sd)(generator); }
};

double target_deg(const World& world, int eye, int axis) {
  const double offset_m = axis == 0 ? (eye == 0 ? -kEyeOffsetM : kEyeOffsetM) : 0;
  return std::atan2(world.target_m[static_cast<std::size_t>(axis)] - offset_m, kWallM) * kDegPerRad;
}

/// One frame of a controller that waits 120 ms after a jump and then moves at most 350 deg/s.
void advance(World& world, double time_s) {
  if (time_s >= world.next_jump_s) {
    world.target_m = {world.uniform(-0.22, 0.22), world.uniform(-0.13, 0.13)};
    world.next_jump_s = time_s + world.uniform(0.6, 1.4);
    world.saccade_at_s = time_s + 0.12 + world.uniform(0, 0.04);
  }
  for (int eye = 0; eye < 2; ++eye) {
    for (int axis = 0; axis < 2; ++axis) {
      double& gaze = world.gaze_deg[static_cast<std::size_t>(eye)][static_cast<std::size_t>(axis)];
      if (time_s >= world.saccade_at_s) {
        const double limit = (axis == 0 ? 330 : 240) / kRateHz;
        gaze += std::clamp(0.93 * (target_deg(world, eye, axis) - gaze), -limit, limit);
      }
      gaze += world.normal(0.05);
    }
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double mean_deg = (world.gaze_deg[0][axis] + world.gaze_deg[1][axis]) / 2;
    world.neck_deg[axis] += 0.04 * ((std::abs(mean_deg) > 12 ? 0.5 * mean_deg : 0) - world.neck_deg[axis]);
  }
}

RecordedFrame observe(const World& world, std::size_t index, bool has_truth) {
  RecordedFrame frame;
  frame.time_ns = static_cast<TimeNs>(std::llround(static_cast<double>(index) * 1e9 / kRateHz));
  frame.tick = static_cast<std::uint64_t>(frame.time_ns) / kTickNs;
  frame.has_truth = has_truth;
  frame.target_on_wall_m = world.target_m;
  for (std::size_t e = 0; e < 2; ++e) {
    EyeTruth& truth = frame.eye[e];
    truth.gaze_pan_deg = world.gaze_deg[e][0];
    truth.gaze_tilt_deg = world.gaze_deg[e][1];
    truth.target_pan_deg = target_deg(world, static_cast<int>(e), 0);
    truth.target_tilt_deg = target_deg(world, static_cast<int>(e), 1);
    truth.error_pan_deg = truth.target_pan_deg - truth.gaze_pan_deg;
    truth.error_tilt_deg = truth.target_tilt_deg - truth.gaze_tilt_deg;
    truth.gaze_on_wall_m = {(e == 0 ? -kEyeOffsetM : kEyeOffsetM) + kWallM * std::tan(truth.gaze_pan_deg / kDegPerRad),
                            kWallM * std::tan(truth.gaze_tilt_deg / kDegPerRad)};
    frame.position_deg[2 * e] = truth.gaze_pan_deg - world.neck_deg[0];
    frame.position_deg[2 * e + 1] = truth.gaze_tilt_deg - world.neck_deg[1];
    frame.goal_deg[2 * e] = truth.target_pan_deg - world.neck_deg[0];
    frame.goal_deg[2 * e + 1] = truth.target_tilt_deg - world.neck_deg[1];
    const double col = std::clamp(4 + truth.error_pan_deg / 6, 0.0, 7.99);
    const double row = std::clamp(4 - truth.error_tilt_deg / 6, 0.0, 7.99);
    frame.active_fields[e] = {static_cast<std::uint32_t>(row) * 8 + static_cast<std::uint32_t>(col)};
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    frame.position_deg[4 + axis] = world.neck_deg[axis];
    frame.goal_deg[4 + axis] = world.neck_deg[axis] * 1.1;
  }
  frame.decoded_deg = frame.goal_deg;
  return frame;
}

struct Planned {
  const char* name;
  const char* nucleus;
  std::uint32_t size;
  int kind;  // 0 retina, 1 burst right, 2 burst left, 3 pause, 4 tonic right, 5 tonic left, 6 silent
};

constexpr Planned kPopulations[] = {{"retina.left", "retina", 64, 0},
                                    {"retina.right", "retina", 64, 0},
                                    {"SC.left", "SC", 30, 2},
                                    {"SC.right", "SC", 30, 1},
                                    {"LLBN.left", "PPRF", 12, 2},
                                    {"LLBN.right", "PPRF", 12, 1},
                                    {"EBN.left", "PPRF", 12, 2},
                                    {"EBN.right", "PPRF", 12, 1},
                                    {"IBN.left", "PPRF", 6, 2},
                                    {"IBN.right", "PPRF", 6, 1},
                                    {"OPN", "raphe interpositus", 8, 3},
                                    {"TN.left", "NPH", 20, 5},
                                    {"TN.right", "NPH", 20, 4},
                                    {"MN.left_lateral_rectus", "abducens", 20, 5},
                                    {"MN.left_medial_rectus", "oculomotor nucleus", 20, 4},
                                    {"S.left", "central mesencephalic", 4, 6}};

double rate_hz(const Planned& plan, double pan_velocity_deg_s, double pan_deg) {
  switch (plan.kind) {
    case 1:
      return std::max(0.0, pan_velocity_deg_s * 2.2);
    case 2:
      return std::max(0.0, -pan_velocity_deg_s * 2.2);
    case 3:
      return std::abs(pan_velocity_deg_s) > 40 ? 0 : 110;
    case 4:
      return std::max(0.0, 40 + 2 * pan_deg);
    case 5:
      return std::max(0.0, 40 - 2 * pan_deg);
    default:
      return 0;
  }
}

void add_spikes(Recording& recording, World& world, const RecordedFrame& frame, double velocity_deg_s) {
  const auto ticks = static_cast<std::uint64_t>(1e9 / kRateHz) / kTickNs;
  std::vector<RecordedSpike> spikes;
  for (std::size_t p = 0; p < recording.populations.size(); ++p) {
    const RecordedPopulation& population = recording.populations[p];
    for (std::uint32_t i = 0; i < population.size; ++i) {
      double rate = rate_hz(kPopulations[p], velocity_deg_s, frame.position_deg[0]);
      if (kPopulations[p].kind == 0) {
        rate = frame.active_fields[p][0] == i ? 100 : 0;
      }
      const double expected = rate / kRateHz;
      const int count = std::poisson_distribution<int>(std::max(1e-9, expected))(world.generator);
      for (int k = 0; k < count; ++k) {
        spikes.push_back({frame.tick + static_cast<std::uint64_t>(world.uniform(0, static_cast<double>(ticks))),
                          population.first_neuron + i});
      }
    }
  }
  std::sort(spikes.begin(), spikes.end(), [](const RecordedSpike& a, const RecordedSpike& b) {
    return a.tick != b.tick ? a.tick < b.tick : a.neuron < b.neuron;
  });
  recording.spikes.insert(recording.spikes.end(), spikes.begin(), spikes.end());
}

}  // namespace

Recording synthetic_recording(const SyntheticOptions& options) {
  Recording recording;
  recording.circuit_name = "oculomotor";
  recording.scenario = options.has_truth ? "random" : "video";
  recording.seed = options.seed;
  recording.tick_ns = kTickNs;
  recording.frame_period_ns = static_cast<TimeNs>(1e9 / kRateHz);
  recording.duration_s = options.duration_s;
  recording.wall_distance_m = options.has_truth ? kWallM : 0;
  std::uint32_t neuron = 0;
  for (const Planned& plan : kPopulations) {
    recording.populations.push_back({plan.name, plan.nucleus, neuron, plan.size});
    neuron += plan.size;
  }
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    RecordedRetina retina{eye == Eye::Left ? "left" : "right", eye, 65, 640, 640, {}};
    for (int k = 0; k < 64; ++k) {
      const auto x = static_cast<float>(k % 8 * 80);
      const auto y = static_cast<float>(k / 8 * 80);
      retina.fields.push_back({x, y, x + 80, y + 80});
    }
    recording.retinas.push_back(retina);
  }
  World world;
  world.generator.seed(options.seed);
  const auto frames = static_cast<std::size_t>(options.duration_s * kRateHz);
  for (std::size_t k = 0; k < frames; ++k) {
    const double before_deg = world.gaze_deg[0][0];
    advance(world, static_cast<double>(k) / kRateHz);
    recording.frames.push_back(observe(world, k, options.has_truth));
    add_spikes(recording, world, recording.frames.back(), (world.gaze_deg[0][0] - before_deg) * kRateHz);
  }
  return recording;
}

}  // namespace tectum
