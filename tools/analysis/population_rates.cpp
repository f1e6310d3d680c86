#include "tools/analysis/population_rates.h"

#include <algorithm>
#include <cmath>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/spike_times.h"

namespace tectum {
std::vector<PopulationRate> population_rates(const Recording& recording, const RateOptions& options) {
  std::vector<PopulationRate> rates;
  const double length_s = options.end_s - options.begin_s;
  const auto bins = length_s > 0 ? static_cast<std::size_t>(std::ceil(length_s / options.bin_s - 1e-9)) : 0;
  for (const RecordedPopulation& population : recording.populations) {
    rates.push_back({population.name, std::vector<double>(bins, 0.0)});
  }
  const std::vector<std::uint32_t> index = population_of_neurons(recording);
  SpikeClock clock(recording);
  for (const RecordedSpike& spike : spikes_between(recording, options.begin_s, options.end_s)) {
    if (bins == 0 || spike.neuron >= index.size() || index[spike.neuron] == kNoPopulation) {
      continue;
    }
    // Half a nanosecond forgives the rounding of a tick's time at a bin's edge.
    const double since_s = std::max(0.0, clock.time_s(spike.tick) - options.begin_s + 0.5e-9);
    const std::size_t bin = std::min(static_cast<std::size_t>(since_s / options.bin_s), bins - 1);
    rates[index[spike.neuron]].rate_hz[bin] += 1;
  }
  for (std::size_t p = 0; p < rates.size(); ++p) {
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const double width_s = std::min(options.bin_s, length_s - static_cast<double>(bin) * options.bin_s);
      rates[p].rate_hz[bin] /= std::max(1.0, static_cast<double>(recording.populations[p].size)) * width_s;
    }
  }
  return rates;
}

std::vector<PopulationSummary> population_summaries(const Recording& recording) {
  std::vector<PopulationSummary> summaries(recording.populations.size());
  const std::vector<std::uint32_t> index = population_of_neurons(recording);
  std::vector<bool> has_fired(index.size(), false);
  for (const RecordedSpike& spike : recording.spikes) {
    if (spike.neuron < index.size() && index[spike.neuron] != kNoPopulation) {
      summaries[index[spike.neuron]].spikes += 1;
      has_fired[spike.neuron] = true;
    }
  }
  const TimeRange range = time_range(recording);
  const double length_s = range.end_s - range.begin_s;
  const std::vector<PopulationRate> rates = population_rates(recording, {range.begin_s, range.end_s, 0.02});
  for (std::size_t p = 0; p < summaries.size(); ++p) {
    const RecordedPopulation& population = recording.populations[p];
    if (population.size == 0 || length_s <= 0) {
      continue;
    }
    const auto first = has_fired.begin() + population.first_neuron;
    summaries[p].mean_rate_hz = static_cast<double>(summaries[p].spikes) / population.size / length_s;
    summaries[p].active_share = static_cast<double>(std::count(first, first + population.size, true)) / population.size;
    for (const double rate_hz : rates[p].rate_hz) {
      summaries[p].peak_rate_hz = std::max(summaries[p].peak_rate_hz, rate_hz);
    }
  }
  return summaries;
}

std::optional<std::size_t> population_of(const Recording& recording, std::uint32_t neuron) {
  for (std::size_t p = 0; p < recording.populations.size(); ++p) {
    const RecordedPopulation& population = recording.populations[p];
    if (neuron >= population.first_neuron && neuron - population.first_neuron < population.size) {
      return p;
    }
  }
  return std::nullopt;
}

}  // namespace tectum
