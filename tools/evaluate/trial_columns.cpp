#include "tools/evaluate/trial_columns.h"

#include <algorithm>
#include <cmath>

#include "tools/evaluate/eye_plant.h"

namespace tectum {
namespace {

constexpr double kSmallestSaccadeDeg = 1;

}  // namespace

std::optional<std::size_t> TrialColumns::population(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? std::nullopt : std::optional<std::size_t>(found - names.begin());
}

double TrialColumns::rate(std::size_t population, double from_s, double to_s) const {
  const std::vector<double>& row = rate_hz[population];
  const auto first = static_cast<std::size_t>(std::clamp(from_s / kSampleS, 0.0, static_cast<double>(row.size())));
  const auto last = static_cast<std::size_t>(std::clamp(to_s / kSampleS, 0.0, static_cast<double>(row.size())));
  double sum = 0;
  for (std::size_t k = first; k < last; ++k) {
    sum += row[k];
  }
  return last > first ? sum / static_cast<double>(last - first) : 0;
}

TrialColumns trial_columns(const SpikeImage& image, const Recording& recording) {
  TrialColumns columns;
  const double tick_s = static_cast<double>(recording.tick_ns) * 1e-9;
  const auto ticks_each = static_cast<std::uint64_t>(std::max(1.0, std::round(TrialColumns::kSampleS / tick_s)));
  const auto samples = static_cast<std::size_t>(recording.duration_s / TrialColumns::kSampleS);
  for (const RecordedPopulation& population : recording.populations) {
    columns.names.push_back(population.name);
    columns.rate_hz.emplace_back(samples, 0.0);
  }
  std::vector<std::uint32_t> population_of;
  for (std::size_t p = 0; p < recording.populations.size(); ++p) {
    const RecordedPopulation& population = recording.populations[p];
    population_of.resize(std::max<std::size_t>(population_of.size(), population.first_neuron + population.size), 0);
    std::fill_n(population_of.begin() + population.first_neuron, population.size, static_cast<std::uint32_t>(p));
  }
  for (const RecordedSpike& spike : recording.spikes) {
    const std::uint64_t k = spike.tick / ticks_each;
    if (k < samples) {
      const std::uint32_t p = population_of[spike.neuron];
      columns.rate_hz[p][k] += 1 / (TrialColumns::kSampleS * recording.populations[p].size);
    }
  }
  columns.eye = eye_movements(image, recording)[0];
  SaccadeOptions options;
  options.min_threshold_deg_s = 40;
  options.min_amplitude_deg = kSmallestSaccadeDeg;
  columns.saccades = detect_saccades(columns.eye, options);
  std::erase_if(columns.saccades, [](const Saccade& s) { return s.onset_s < 1; });  // the head's start
  columns.jumps_s = target_jump_times_s(recording);
  return columns;
}

}  // namespace tectum
