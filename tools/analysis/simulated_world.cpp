#include "tools/analysis/simulated_world.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>

namespace tectum {
namespace {

constexpr std::array<double, 2> kJumpDeg = {10, 0};

std::array<double, 2> on_wall_m(const std::array<double, 2>& deg, double wall_m) {
  const auto metres = [&](double angle_deg) { return wall_m * std::tan(angle_deg * std::numbers::pi / 180); };
  return {metres(deg[0]), metres(deg[1])};
}

/// Straight ahead first, so that the eyes have taken up their vergence when the first jump comes.
std::vector<PathPoint> jumps(const SimulatedWorld& world, const std::array<double, 2>& to_m) {
  std::vector<PathPoint> path;
  std::array<double, 2> at_m{};
  for (int k = 0; k * world.hold_s < world.duration_s; ++k) {
    path.push_back({k * world.hold_s, at_m});
    path.push_back({(k + 1) * world.hold_s, at_m});
    at_m = k % 2 == 0 ? to_m : std::array<double, 2>{};
  }
  return path;
}

}  // namespace

const std::vector<std::string>& world_scenarios() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all(std::begin(kScenarioNames), std::end(kScenarioNames));
    all.emplace_back("jump");
    return all;
  }();
  return names;
}

SimulatedRunOptions world_options(const SpikeImage& image, const SimulatedWorld& world) {
  SimulatedRunOptions options;
  options.head = fitted_to(image, options.head);
  options.duration_s = world.duration_s;
  SimHeadParams& head = options.head;
  head.seed = world.seed;
  head.frame_period_ns = static_cast<TimeNs>(std::llround(1e9 / world.frame_rate_hz));
  head.camera_latency_frames = world.camera_latency_frames;
  head.scenario.kind = scenario_from_name(world.scenario).value_or(ScenarioKind::Random);
  head.scenario.random_hold_s = world.hold_s;
  if (world.to_deg) {
    head.scenario.hold_at_m = on_wall_m(*world.to_deg, head.geometry.wall_distance_m);
  }
  if (world.scenario == "jump") {
    head.scenario.kind = ScenarioKind::Path;
    head.scenario.path = jumps(world, on_wall_m(world.to_deg.value_or(kJumpDeg), head.geometry.wall_distance_m));
  }
  head.camera.width_px = world.resolution_px;
  head.camera.height_px = world.resolution_px;
  head.camera.noise_sigma = world.noise;
  head.camera.clutter = world.clutter;
  if (!world.dot.empty()) {
    head.camera.dot_colour = world.dot == "green"  ? DotColour::Green
                             : world.dot == "blue" ? DotColour::Blue
                                                   : DotColour::Red;
  }
  return options;
}

std::string world_arguments(const SimulatedWorld& world) {
  const SimulatedWorld usual;
  std::string text = fmt::format(" --scenario {}", world.scenario);
  text += world.to_deg ? fmt::format(" --to {} {}", (*world.to_deg)[0], (*world.to_deg)[1]) : "";
  text += world.hold_s != usual.hold_s ? fmt::format(" --hold {}", world.hold_s) : "";
  text += fmt::format(" --duration {:.10g} --seed {}", world.duration_s, world.seed);
  const auto add = [&](const char* name, const auto& value, const auto& as_usual) {
    text += value != as_usual ? fmt::format(" --{} {}", name, value) : "";
  };
  add("frame-rate", world.frame_rate_hz, usual.frame_rate_hz);
  add("camera-latency", world.camera_latency_frames, usual.camera_latency_frames);
  add("resolution", world.resolution_px, usual.resolution_px);
  add("noise", world.noise, usual.noise);
  add("dot", world.dot, usual.dot);
  return text + (world.clutter ? " --clutter" : "");
}

}  // namespace tectum
