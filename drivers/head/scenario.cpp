#include "drivers/head/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/head/random_streams.h"

namespace tectum {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// In units of the extent.
constexpr std::array<std::array<double, 2>, 8> kStepPoints = {
    {{1, -1}, {1, 0}, {1, 1}, {0, 0}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}}};

// Between two wall points, seen from the head.
double angle_deg(const std::array<double, 2>& a, const std::array<double, 2>& b, double wall_m) {
  const double dot = a[0] * b[0] + a[1] * b[1] + wall_m * wall_m;
  const double length_a = std::hypot(a[0], a[1], wall_m);
  const double length_b = std::hypot(b[0], b[1], wall_m);
  return std::acos(std::clamp(dot / (length_a * length_b), -1.0, 1.0)) / kRadPerDeg;
}

}  // namespace

const char* scenario_name(ScenarioKind kind) {
  return kind == ScenarioKind::Path ? "path" : kScenarioNames[static_cast<std::size_t>(kind)];
}

std::optional<ScenarioKind> scenario_from_name(std::string_view name) {
  for (std::size_t i = 0; i < kScenarioNames.size(); ++i) {
    if (name == kScenarioNames[i]) {
      return static_cast<ScenarioKind>(i);
    }
  }
  return std::nullopt;
}

Scenario::Scenario(const ScenarioParams& params) : params_(params) {
  const double shortest_s = std::max(params_.chirp_shortest_period_s, 0.05);
  params_.chirp_ratio = std::max(params_.chirp_ratio, 1.01);
  params_.chirp_shortest_period_s = shortest_s;
  for (double period_s = params_.chirp_first_period_s; period_s >= shortest_s; period_s /= params_.chirp_ratio) {
    chirp_cycle_s_ += period_s;
  }
}

std::array<double, 2> Scenario::target_m(TimeNs time_ns) {
  const double time_s = static_cast<double>(std::max<TimeNs>(time_ns, 0)) * 1e-9;
  switch (params_.kind) {
    case ScenarioKind::Hold:
      return params_.hold_at_m;
    case ScenarioKind::Step: {
      const auto index = static_cast<std::uint64_t>(time_s / params_.step_hold_s) % kStepPoints.size();
      return {kStepPoints[index][0] * params_.extent_m, kStepPoints[index][1] * params_.extent_m};
    }
    case ScenarioKind::Circle:
      return on_circle(time_s / params_.circle_period_s);
    case ScenarioKind::Chirp:
      return chirp_m(time_s);
    case ScenarioKind::Random:
      return random_place(static_cast<std::size_t>(time_s / params_.random_hold_s));
    case ScenarioKind::Path:
      return on_path(time_s).at_m;
  }
  return {};
}

double Scenario::target_distance_m(TimeNs time_ns) const {
  return params_.kind == ScenarioKind::Path
             ? on_path(static_cast<double>(std::max<TimeNs>(time_ns, 0)) * 1e-9).distance_m
             : params_.wall_distance_m;
}

PathPoint Scenario::on_path(double time_s) const {
  const auto with_plane = [&](PathPoint point) {
    point.distance_m = point.distance_m > 0 ? point.distance_m : params_.wall_distance_m;
    return point;
  };
  const auto after = std::upper_bound(params_.path.begin(), params_.path.end(), time_s,
                                      [](double t, const PathPoint& point) { return t < point.time_s; });
  if (params_.path.empty() || after == params_.path.begin()) {
    return with_plane(params_.path.empty() ? PathPoint{} : *after);
  }
  const PathPoint from = with_plane(*std::prev(after));
  if (after == params_.path.end()) {
    return from;
  }
  const PathPoint to = with_plane(*after);
  const double share = (time_s - from.time_s) / (to.time_s - from.time_s);
  return {time_s,
          {from.at_m[0] + share * (to.at_m[0] - from.at_m[0]), from.at_m[1] + share * (to.at_m[1] - from.at_m[1])},
          from.distance_m + share * (to.distance_m - from.distance_m)};
}

std::array<double, 2> Scenario::on_circle(double turn) const {
  const double angle = 2 * std::numbers::pi * turn - std::numbers::pi / 2;
  return {params_.extent_m * std::cos(angle), params_.extent_m * std::sin(angle)};
}

std::array<double, 2> Scenario::chirp_m(double time_s) const {
  if (chirp_cycle_s_ <= 0) {  // the first period is already too short
    return on_circle(time_s / params_.chirp_shortest_period_s);
  }
  double left_s = std::fmod(time_s, chirp_cycle_s_);
  double period_s = params_.chirp_first_period_s;
  while (left_s >= period_s && period_s / params_.chirp_ratio >= params_.chirp_shortest_period_s) {
    left_s -= period_s;
    period_s /= params_.chirp_ratio;
  }
  return on_circle(left_s / period_s);
}

std::array<double, 2> Scenario::random_place(std::size_t index) {
  const double half_width_m = params_.wall_distance_m * std::tan(params_.random_pan_deg * kRadPerDeg);
  const double half_height_m = params_.wall_distance_m * std::tan(params_.random_tilt_deg * kRadPerDeg);
  if (random_places_.empty()) {
    random_places_.push_back({0, 0});
  }
  // A rejection rate above nine in ten is not reached with a jump of a few degrees or more; a jump too small for
  // 4096 tries leaves the dot where it is.
  constexpr std::uint32_t kTries = 4096;
  while (random_places_.size() <= index) {
    const std::array<double, 2> last = random_places_.back();
    std::array<double, 2> next = last;
    for (std::uint32_t attempt = 0; attempt < kTries; ++attempt) {
      const auto words = head::draw(params_.seed, head::Stream::RandomTarget, random_places_.size(), attempt);
      const std::array<double, 2> place = {(2 * head::unit_interval(words[0]) - 1) * half_width_m,
                                           (2 * head::unit_interval(words[1]) - 1) * half_height_m};
      if (angle_deg(last, place, params_.wall_distance_m) <= params_.random_jump_deg) {
        next = place;
        break;
      }
    }
    random_places_.push_back(next);
  }
  return random_places_[index];
}

}  // namespace tectum
