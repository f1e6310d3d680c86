#include "tools/diff/battery.h"

#include <cmath>
#include <numbers>

#include "runtime/image/philox.h"

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

class BatteryBuilder {
 public:
  BatteryBuilder(std::uint64_t seed, double wall_m) : seed_(seed), wall_m_(wall_m) {
    battery_.scenario.kind = ScenarioKind::Path;
    battery_.scenario.path.push_back({0, {0, 0}});
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
    battery_.parts.push_back({kind, now_s_, now_s_ + length_s, at_deg_, to_deg});
    now_s_ += length_s;
    at_deg_ = to_deg;
  }
  void rest(double length_s) {
    battery_.scenario.path.push_back({now_s_ + length_s, on_wall(at_deg_)});
    add(PartKind::Fixation, length_s, at_deg_);
  }
  void step(const std::array<double, 2>& to_deg) {
    const double wait_s = kOnsetJitterS * (draw() + 1) / 2;
    battery_.scenario.path.push_back({now_s_ + wait_s, on_wall(at_deg_)});
    now_s_ += wait_s;
    battery_.scenario.path.push_back({now_s_, on_wall(to_deg)});
    battery_.scenario.path.push_back({now_s_ + kHoldS, on_wall(to_deg)});
    add(PartKind::Step, kHoldS, to_deg);
  }
  void ramp(const std::array<double, 2>& to_deg, double length_s) {
    battery_.scenario.path.push_back({now_s_ + length_s, on_wall(to_deg)});
    add(PartKind::Pursuit, length_s, to_deg);
  }

  std::uint64_t seed_;
  double wall_m_;
  std::uint32_t draws_ = 0;
  double now_s_ = 0;
  std::array<double, 2> at_deg_{};
  Battery battery_;
};

}  // namespace

Battery make_battery(std::uint64_t seed, double wall_distance_m) {
  return BatteryBuilder(seed, wall_distance_m).build();
}

SimulatedRunOptions battery_options(const SpikeImage& fitted_image, const Battery& battery, std::uint64_t seed) {
  SimulatedRunOptions options;
  options.head.seed = seed;
  options.head.scenario = battery.scenario;
  options.head = fitted_to(fitted_image, options.head);
  options.duration_s = battery.duration_s;
  options.sample_rate_hz = kSampleRateHz;
  return options;
}

}  // namespace tectum
