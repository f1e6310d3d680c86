// What the command line and test files can say of the simulated world, in one place, so that a test can name the
// command that repeats it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/analysis/simulated_run.h"

namespace tectum {

struct SimulatedWorld {
  std::string scenario = "random";  // one of world_scenarios()
  double duration_s = 60;
  std::uint64_t seed = 1;
  double frame_rate_hz = 45;  // the published loop
  std::uint32_t camera_latency_frames = 1;
  double hold_s = 1;                            // between the jumps of random and jump
  std::optional<std::array<double, 2>> to_deg;  // where hold rests and jump goes to: right, up; nothing: as usual
  int resolution_px = 320;
  double noise = 0;
  bool clutter = false;
  std::string dot;  // "red", "green", "blue"; empty: the colour that the retina looks for
};

/// Those of drivers/head/scenario.h, and "jump": straight ahead and at to_deg by turns, hold_s each.
[[nodiscard]] const std::vector<std::string>& world_scenarios();

[[nodiscard]] SimulatedRunOptions world_options(const SpikeImage& image, const SimulatedWorld& world);

/// The options of `tectum run` for this world: " --scenario step --duration 8 --seed 3"; what is as usual is left out.
[[nodiscard]] std::string world_arguments(const SimulatedWorld& world);

}  // namespace tectum
