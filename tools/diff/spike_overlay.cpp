#include "tools/diff/spike_overlay.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "tools/diff/lock_step.h"

namespace tectum {
namespace {

bool comes_before(const RecordedSpike& x, const RecordedSpike& y) {
  return x.tick != y.tick ? x.tick < y.tick : x.neuron < y.neuron;
}

/// With the neurons of the second circuit; those without a counterpart are left out.
std::vector<RecordedSpike> as_in_b(const CircuitView& a, const CircuitView& b, const Correspondence& match,
                                   const std::vector<RecordedSpike>& spikes) {
  std::vector<std::uint32_t> in_b(a.image.header.neuron_count);
  for (std::uint32_t neuron = 0; neuron < in_b.size(); ++neuron) {
    in_b[neuron] = counterpart(a, b, match, neuron);
  }
  std::vector<RecordedSpike> mapped;
  for (const RecordedSpike& spike : spikes) {
    if (in_b[spike.neuron] != kNoMatch) {
      mapped.push_back({spike.tick, in_b[spike.neuron]});
    }
  }
  std::sort(mapped.begin(), mapped.end(), comes_before);
  return mapped;
}

/// Frames give the spikes their times.
Recording empty_like(const Recording& recording, const std::vector<RecordedPopulation>& populations) {
  Recording empty;
  empty.tick_ns = recording.tick_ns;
  empty.frame_period_ns = recording.frame_period_ns;
  empty.duration_s = recording.duration_s;
  empty.frames = recording.frames;
  empty.populations = populations;
  return empty;
}

std::vector<RecordedPopulation> most_different(const Behaviour& behaviour, std::size_t most) {
  std::vector<std::pair<double, std::string>> order;
  for (const PopulationDifference& population : behaviour.populations) {
    order.emplace_back(-population.van_rossum, population.name);
  }
  std::sort(order.begin(), order.end());
  // What the first difference leads to comes before what ends up most different.
  std::set<std::string> chosen;
  for (const DivergenceLink& link : behaviour.divergence.links) {
    if (!link.population.empty() && chosen.size() < most) {
      chosen.insert(link.population);
    }
  }
  for (const auto& [distance, name] : order) {
    if (chosen.size() < most) {
      chosen.insert(name);
    }
  }
  std::vector<RecordedPopulation> populations;
  for (const RecordedPopulation& population : behaviour.first_b.populations) {
    if (chosen.count(population.name) != 0) {
      populations.push_back(population);
    }
  }
  return populations;
}

}  // namespace

SpikeOverlay::SpikeOverlay(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                           const Behaviour& behaviour, std::size_t most_populations) {
  const std::vector<RecordedPopulation> populations = most_different(behaviour, most_populations);
  const std::vector<RecordedSpike> x = as_in_b(a, b, structure.match, behaviour.first_a.spikes);
  std::vector<RecordedSpike> y = behaviour.first_b.spikes;
  std::sort(y.begin(), y.end(), comes_before);
  both_ = empty_like(behaviour.first_a, populations);
  only_a_ = both_;
  only_b_ = empty_like(behaviour.first_b, populations);
  // Ticks of two lengths never name the same moment.
  if (behaviour.first_a.tick_ns == behaviour.first_b.tick_ns) {
    std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both_.spikes), comes_before);
    std::set_difference(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(only_a_.spikes), comes_before);
    std::set_difference(y.begin(), y.end(), x.begin(), x.end(), std::back_inserter(only_b_.spikes), comes_before);
  } else {
    only_a_.spikes = x;
    only_b_.spikes = y;
  }
  either_ = empty_like(behaviour.first_b, populations);
  either_.spikes = x;
  either_.spikes.insert(either_.spikes.end(), y.begin(), y.end());
  std::sort(either_.spikes.begin(), either_.spikes.end(), comes_before);
  summaries_ = population_summaries(either_);
}

std::string SpikeOverlay::picture(const LanePlotOptions& options, const std::string& description) const {
  return OverlayPlot({{&both_, "target"}, {&only_a_, "left"}, {&only_b_, "right"}}, summaries_, options)
      .responsive(description);
}

}  // namespace tectum
