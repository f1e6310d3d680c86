// What the differences between two circuits do: closed loop, the same target and the same noise for both, over seeds.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/diff/battery.h"
#include "tools/diff/divergence.h"
#include "tools/diff/kinematics.h"

namespace tectum {

/// A number of both circuits, by seed; seeds in which one of them has no such number are left out.
struct PairedFigure {
  std::string name, unit;
  std::vector<double> a, b;

  [[nodiscard]] double mean_a() const;
  [[nodiscard]] double mean_b() const;
  [[nodiscard]] double difference() const { return mean_b() - mean_a(); }
  /// Standard deviation of the difference over the seeds. A seed is the same noise and the same target for both, so
  /// that what both owe to it drops out. 0 for one seed.
  [[nodiscard]] double spread() const;
  /// Every seed differs in the same direction, and the mean difference is larger than its spread. Nothing for one seed.
  [[nodiscard]] std::optional<bool> exceeds_spread() const;
};

struct PopulationDifference {
  std::string name;   // of the second circuit
  PairedFigure rate;  // Hz, mean of a neuron
  /// ms from a jump of the target until the population's rate has done half of its way to its highest or lowest; mean
  /// over the jumps that it answers in both circuits. Without seeds where it answers none.
  PairedFigure latency;
  /// The shift, positive when the second is later, at which the two rate profiles agree best (first seed, bins of 1 ms
  /// smoothed by 3 ms, up to 40 ms either way); nothing for a population without a profile.
  std::optional<double> lag_ms;
  /// Means over up to 16 neurons that fire in either circuit, first seed: tau 10 ms; 0.1 a ms; the whole run.
  double van_rossum = 0, victor_purpura = 0, spike = 0;
};

struct Behaviour {
  bool is_closed_loop = true;  // false: one of the two was driven by a recording, or both were recorded
  bool is_same = false;        // every spike and command of every seed
  std::string what;            // "fixation, steps in eight directions and a pursuit ramp, 5.3 s, seeds 1 to 4"
  std::vector<PairedFigure> kinematics;
  std::vector<PopulationDifference> populations;  // those whose spikes differ, in the order of the second circuit
  Divergence divergence;
  Recording first_a, first_b;  // of the first seed, for pictures
  std::vector<RunPart> first_parts;
};

struct BehaviourOptions {
  BatteryPlan plan = {};
  std::uint64_t seeds = 4;
  unsigned threads = 0;  // 0: one for each core
  std::function<void(double)> progress;
};

[[nodiscard]] Behaviour compare_behaviour(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                                          const BehaviourOptions& options);

/// Two recordings of the same input, or of the same target.
struct RecordingPair {
  const Recording& a;
  const Recording& b;
  std::vector<RunPart> parts;
};

/// Rates, latencies, lags and distances, one pair a seed. Populations are matched by index. threads = 0: one for each
/// core.
[[nodiscard]] std::vector<PopulationDifference> compare_spikes(const std::vector<RecordingPair>& pairs,
                                                               const std::vector<std::uint32_t>& population_of_b,
                                                               unsigned threads = 0);

/// Figure by figure; a run without one is left out.
void add_kinematics(const RecordingPair& pair, std::vector<PairedFigure>& figures);

/// One line: what was changed, where it shows first, and what it does to the eyes.
[[nodiscard]] std::string verdict_text(const StructureDiff& structure, const Behaviour& behaviour);

/// Lines for people.
[[nodiscard]] std::string behaviour_text(const Behaviour& behaviour);

}  // namespace tectum
