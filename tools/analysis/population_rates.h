// Firing rates of a recording's populations.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/record/recording.h"

namespace tectum {

/// Mean rate of a neuron of the population in each bin [begin + k * bin, begin + (k + 1) * bin).
struct PopulationRate {
  std::string population;
  std::vector<double> rate_hz;
};

struct RateOptions {
  double begin_s = 0;
  double end_s = 0;
  double bin_s = 0.02;
};

/// One entry a population, in recording order. The last bin is cut off at end_s and scaled to its width.
[[nodiscard]] std::vector<PopulationRate> population_rates(const Recording&, const RateOptions&);

struct PopulationSummary {
  std::size_t spikes = 0;
  double mean_rate_hz = 0;  // spikes / size / recorded time
  double peak_rate_hz = 0;  // largest 20 ms bin
  double active_share = 0;  // neurons that fired at all
};

/// One entry a population, in recording order.
[[nodiscard]] std::vector<PopulationSummary> population_summaries(const Recording&);

/// Index into populations of the one that holds the neuron.
[[nodiscard]] std::optional<std::size_t> population_of(const Recording&, std::uint32_t neuron);

}  // namespace tectum
