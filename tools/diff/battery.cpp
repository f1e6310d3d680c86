#include "tools/diff/battery.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/image/philox.h"
#include "tools/analysis/gaze_traces.h"

namespace tectum {
namespace {

constexpr double kStepDeg = 10;
constexpr double kHoldS = 0.4;  // a saccade of 10 deg, a correction, and some rest
constexpr double kFixationS = 0.5;
constexpr double kRampDegS = 12;
constexpr double kRampS = 1;
constexpr double kOnsetJitterS = 0.022;  // a frame of 45 Hz
constexpr double kSizeJitter = 0.1;
constexpr double kSampleRateHz = 500;
constexpr double kSettledAfterS = 0.6;
constexpr double kSlowestPursuitDegS = 2;  // above what a moving neck does to the target's direction seen from an eye

class BatteryBuilder {
 public:
  BatteryBuilder(std::uint64_t seed, double wall_m) : seed_(seed), wall_m_(wall_m) {
    battery_.head.seed = seed;
    path().push_back({0, {0, 0}});
    battery_.head.scenario.kind = ScenarioKind::Path;
  }

  Battery build() {
    rest(kFixationS);
    // Out and back: each of the four goes in two of the eight directions.
    constexpr double kDiagonal = std::numbers::sqrt2 / 2;
    for (const std::array<double, 2>& way : {std::array{1.0, 0.0}, std::array{0.0, 1.0},
                                             std::array{kDiagonal, kDiagonal}, std::array{-kDiagonal, kDiagonal}}) {
      const double size_deg = kStepDeg * (1 + kSizeJitter * draw());
      step({way[0] * size_deg, way[1] * size_deg});
      step({0, 0});
    }
    rest(kFixationS);
    ramp({kRampDegS * kRampS, 0}, kRampS);
    battery_.duration_s = now_s_;
    return std::move(battery_);
  }

 private:
  std::vector<PathPoint>& path() { return battery_.head.scenario.path; }
  /// Uniform in [-1, 1).
  double draw() {
    const PhiloxWords words = philox4x32(seed_, {draws_++, 0, 0, 0xBA77E27U});
    return static_cast<double>(words[0]) * 0x1p-31 - 1;
  }
  [[nodiscard]] std::array<double, 2> on_wall(const std::array<double, 2>& deg) const {
    const auto metres = [&](double angle_deg) { return wall_m_ * std::tan(angle_deg * std::numbers::pi / 180); };
    return {metres(deg[0]), metres(deg[1])};
  }
  void add(PartKind kind, double length_s, const std::array<double, 2>& to_deg) {
    battery_.parts.push_back({kind, now_s_, now_s_ + length_s});
    now_s_ += length_s;
    at_deg_ = to_deg;
  }
  void rest(double length_s) {
    path().push_back({now_s_ + length_s, on_wall(at_deg_)});
    add(PartKind::Fixation, length_s, at_deg_);
  }
  void step(const std::array<double, 2>& to_deg) {
    const double wait_s = kOnsetJitterS * (draw() + 1) / 2;
    path().push_back({now_s_ + wait_s, on_wall(at_deg_)});
    now_s_ += wait_s;
    path().push_back({now_s_, on_wall(to_deg)});
    path().push_back({now_s_ + kHoldS, on_wall(to_deg)});
    add(PartKind::Step, kHoldS, to_deg);
  }
  void ramp(const std::array<double, 2>& to_deg, double length_s) {
    path().push_back({now_s_ + length_s, on_wall(to_deg)});
    add(PartKind::Pursuit, length_s, to_deg);
  }

  std::uint64_t seed_;
  double wall_m_;
  std::uint32_t draws_ = 0;
  double now_s_ = 0;
  std::array<double, 2> at_deg_{};
  Battery battery_;
};

/// Without its first frame, in which the target may still be on its way.
bool moves_between(const AngleTrace& target, double begin_s, double end_s) {
  double way_deg = 0, first_s = end_s, last_s = begin_s;
  for (std::size_t k = 1; k < target.time_s.size(); ++k) {
    if (target.time_s[k - 1] >= begin_s && target.time_s[k] < end_s) {
      way_deg += std::hypot(target.pan_deg[k] - target.pan_deg[k - 1], target.tilt_deg[k] - target.tilt_deg[k - 1]);
      first_s = std::min(first_s, target.time_s[k - 1]);
      last_s = target.time_s[k];
    }
  }
  return last_s > first_s && way_deg / (last_s - first_s) > kSlowestPursuitDegS;
}

}  // namespace

Battery make_battery(const BatteryPlan& plan, std::uint64_t seed) {
  if (plan.is_built_in) {
    return BatteryBuilder(seed, HeadGeometry{}.wall_distance_m).build();
  }
  Battery battery{plan.head, {}, plan.duration_s};
  battery.head.seed = seed;
  return battery;
}

SimulatedRunOptions battery_options(const SpikeImage& fitted_image, const Battery& battery) {
  SimulatedRunOptions options;
  options.head = fitted_to(fitted_image, battery.head);
  options.duration_s = battery.duration_s;
  options.sample_rate_hz = kSampleRateHz;
  return options;
}

std::vector<RunPart> parts_of(const Recording& recording) {
  std::vector<RunPart> parts;
  const AngleTrace target = target_trace(recording, Eye::Left);
  if (target.time_s.size() < 2) {
    return parts;
  }
  std::vector<double> edges_s = target_jump_times_s(recording);
  const std::size_t jumps = edges_s.size();
  edges_s.insert(edges_s.begin(), target.time_s.front());
  edges_s.push_back(time_range(recording).end_s);
  for (std::size_t k = 0; k + 1 < edges_s.size(); ++k) {
    const double begin_s = edges_s[k], end_s = edges_s[k + 1];
    if (moves_between(target, begin_s, end_s)) {
      parts.push_back({PartKind::Pursuit, begin_s, end_s});
    } else if (k == 0 || jumps == 0) {
      parts.push_back({PartKind::Fixation, begin_s, end_s});
    } else {
      parts.push_back({PartKind::Step, begin_s, end_s});
      if (end_s - begin_s > kSettledAfterS + kFixationS) {
        parts.push_back({PartKind::Fixation, begin_s + kSettledAfterS, end_s});
      }
    }
  }
  return parts;
}

}  // namespace tectum
