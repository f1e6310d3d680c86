// What the circuits of a comparison are put through: fixation, steps in eight directions, a pursuit ramp; or another
// target for as long as one likes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/analysis/simulated_run.h"

namespace tectum {

enum class PartKind { Fixation, Step, Pursuit };

/// A stretch [begin, end) of a run in which the target rests, rests after a jump at its beginning, or moves.
struct RunPart {
  PartKind kind = PartKind::Fixation;
  double begin_s = 0, end_s = 0;
};

/// The world of a run.
struct Battery {
  SimHeadParams head;
  std::vector<RunPart> parts;  // empty: as the target's way in the recording shows them (parts_of)
  double duration_s = 0;
};

/// What a comparison runs, by seed.
struct BatteryPlan {
  std::string what = "fixation, steps in eight directions and a pursuit ramp";
  bool is_built_in = true;
  SimHeadParams head;     // of any other one
  double duration_s = 0;  // of any other one
  std::uint64_t first_seed = 1;
};

/// The built-in battery: the seed moves each onset by up to a frame and each size by up to a tenth, so that seeds
/// differ as repetitions of an experiment do. What one seed gives is the same for every circuit.
[[nodiscard]] Battery make_battery(const BatteryPlan& plan, std::uint64_t seed);

/// Fitted to one image, so that two circuits can be put into the same world.
[[nodiscard]] SimulatedRunOptions battery_options(const SpikeImage& fitted_image, const Battery& battery);

/// The parts of a recording whose target is known. A rest that goes on for longer than 0.6 s after a jump is a fixation
/// from then on as well.
[[nodiscard]] std::vector<RunPart> parts_of(const Recording& recording);

}  // namespace tectum
