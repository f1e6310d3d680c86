// What the circuits of a comparison are put through: fixation, steps in eight directions, a pursuit ramp.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/analysis/simulated_run.h"

namespace tectum {

enum class PartKind { Fixation, Step, Pursuit };

/// A stretch [begin, end) of the battery. Directions are seen from the middle of the head, right and up.
struct BatteryPart {
  PartKind kind = PartKind::Fixation;
  double begin_s = 0, end_s = 0;
  std::array<double, 2> from_deg{}, to_deg{};
};

struct Battery {
  ScenarioParams scenario;
  std::vector<BatteryPart> parts;
  double duration_s = 0;
};

/// The seed moves each onset by up to a frame and each size by up to a tenth, so that seeds differ as repetitions of an
/// experiment do; what one seed gives is the same for every circuit.
[[nodiscard]] Battery make_battery(std::uint64_t seed, double wall_distance_m);

/// The world of a run: fitted to one image, so that two circuits can be put into the same.
[[nodiscard]] SimulatedRunOptions battery_options(const SpikeImage& fitted_image, const Battery& battery,
                                                  std::uint64_t seed);

}  // namespace tectum
