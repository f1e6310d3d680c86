// A run as the motoneurons give it: the eye that they would move and every population's rate, in even samples.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/record/recording.h"
#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/saccades.h"

namespace tectum {

/// Sample k covers [k, k + 1) * kSampleS.
struct TrialColumns {
  static constexpr double kSampleS = 0.002;

  AngleTrace eye;                            // the left one, as tools/evaluate/eye_plant.h moves it
  std::vector<std::vector<double>> rate_hz;  // one row a recorded population, mean of its neurons
  std::vector<std::string> names;
  std::vector<double> jumps_s;
  std::vector<Saccade> saccades;  // of that eye, from 1 s on and of 1 deg or more

  [[nodiscard]] std::optional<std::size_t> population(std::string_view name) const;
  /// Mean over [from_s, to_s) of a population's rate.
  [[nodiscard]] double rate(std::size_t population, double from_s, double to_s) const;
};

[[nodiscard]] TrialColumns trial_columns(const SpikeImage& image, const Recording& recording);

}  // namespace tectum
