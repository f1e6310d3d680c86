// How tracking suffers when camera or circuit are worse than they should be, beside an engineer's servo that gets the
// same pictures.
//
// What is done to the camera (noise of the sensor, lost frames, a fainter dot, a brighter room) is done to the PID
// servo as well, which looks for the dot in the picture (tools/evaluate/dot_finder.h). What is done to the circuit
// (dead receptive fields, lost neurons, weights that are off) has no counterpart there.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/measure_table.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {

enum class Disturbance {
  SensorNoise,     // standard deviation in grey levels of 255, each channel of each pixel on its own
  DroppedFrames,   // share of the frames that neither eye ever gives
  DotBrightness,   // grey levels of the dot's channel over the wall
  RoomBrightness,  // grey levels of the wall
  DeadFields,      // share of each retina's neurons that never fire
  LostNeurons,     // share of every other population's neurons that never fire
  WeightNoise,     // each synapse's weight times a factor drawn evenly between 1 - x and 1 + x
  PathwayNoise     // the same with one factor for all synapses from a population (or side) to a receptor of another
};
inline constexpr std::size_t kDisturbances = 8;

struct DisturbanceFacts {
  const char* key;    // in the protocol file
  const char* title;  // of its table and picture
  const char* unit;   // of the level
  double as_shown;    // level times this is what people read
  double lowest, highest;
  bool is_of_the_circuit;
};
[[nodiscard]] const DisturbanceFacts& facts_of(Disturbance disturbance);

/// The levels that each is tried at, in the file's order; none: not tried.
struct RobustnessPlan {
  std::array<std::vector<double>, kDisturbances> levels;
  [[nodiscard]] const std::vector<double>& of(Disturbance disturbance) const {
    return levels[static_cast<std::size_t>(disturbance)];
  }
};

struct ReadRobustness {
  std::optional<RobustnessPlan> plan;
  std::string problems;
};
/// The `robustness` part of a protocol's bytes.
[[nodiscard]] ReadRobustness read_robustness_text(const std::string& name, const std::string& bytes);

/// Each weight times a factor of its own, or of its pathway; the same for the same seed. `share` from 0 to 0.9, so that
/// no sum overflows.
[[nodiscard]] SpikeImage with_weight_noise(const SpikeImage& image, double share, std::uint64_t seed);
[[nodiscard]] SpikeImage with_pathway_noise(const SpikeImage& image, double share, std::uint64_t seed);

/// What an undisturbed head becomes; those that are of the circuit leave it as it is.
void disturb_head(Disturbance disturbance, double level, SimHeadParams& head);

/// A circuit with a share of its fields or neurons silent, compiled anew: which ones depends on the seed.
using LesionedImage = std::function<std::optional<SpikeImage>(Disturbance, double share, std::uint64_t seed)>;

/// RMSE of each trial: mean over the four channels.
struct DisturbedRmse {
  double level = 0;
  std::vector<double> circuit_deg, pid_deg, oracle_deg;  // of the last two none where they are not concerned
};

struct RobustnessResult {
  DisturbedRmse undisturbed;
  std::array<std::vector<DisturbedRmse>, kDisturbances> levels;  // as in the plan
};

/// Deterministic in its arguments, whatever the number of threads. Nothing when a circuit could not be compiled.
[[nodiscard]] std::optional<RobustnessResult> evaluate_robustness(const SpikeImage& image, const Protocol& protocol,
                                                                  const RobustnessPlan& plan,
                                                                  const LesionedImage& lesioned, unsigned threads,
                                                                  const std::function<void(double)>& progress);

/// One table and one picture for each disturbance that was tried.
[[nodiscard]] MeasuredProtocol robustness_tables(const RobustnessResult& result);

}  // namespace tectum
