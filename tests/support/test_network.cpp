#include "tests/support/test_network.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tectum::test {
namespace {

struct Slots {
  std::vector<std::uint32_t> first;          // of each population's group
  std::vector<std::uint32_t> population_of;  // [neuron]
  std::vector<std::uint32_t> index_of;       // [neuron], in its population
};

std::uint32_t slot_of(const TestNetwork& network, const Slots& slots, const TestSynapse& synapse) {
  const std::uint32_t p = slots.population_of[synapse.post];
  return slots.first[p] + synapse.receptor * network.populations[p].physics.size + slots.index_of[synapse.post];
}

// The least q with sum / 2^q < 2^30 for the heaviest slot of each receptor, and at least 2^-40.
std::vector<std::int32_t> choose_quanta(const TestNetwork& network, const Slots& slots, std::uint32_t slot_count) {
  std::vector<double> sum(slot_count, 0.0);
  for (const TestSynapse& synapse : network.synapses) {
    sum[slot_of(network, slots, synapse)] += std::abs(synapse.weight);
  }
  std::vector<std::int32_t> quantum_log2(slot_count);
  for (std::size_t p = 0; p < network.populations.size(); ++p) {
    const ModelPhysics& physics = network.populations[p].physics;
    for (std::size_t r = 0; r < physics.receptors.size(); ++r) {
      const auto begin = sum.begin() + static_cast<std::ptrdiff_t>(slots.first[p] + r * physics.size);
      const double heaviest = *std::max_element(begin, begin + static_cast<std::ptrdiff_t>(physics.size));
      int exponent = 0;
      std::frexp(heaviest, &exponent);
      std::fill_n(quantum_log2.begin() + (begin - sum.begin()), physics.size,
                  heaviest == 0 ? -20 : std::max(exponent - 30, -40));
    }
  }
  return quantum_log2;
}

void add_populations(const TestNetwork& network, ImageContents& image, Slots& slots) {
  std::vector<std::uint32_t> order = network.update_order;
  if (order.empty()) {
    order.resize(network.populations.size());
    std::iota(order.begin(), order.end(), 0U);
  }
  std::uint32_t next = 0;
  for (std::uint32_t p = 0; p < network.populations.size(); ++p) {
    const TestPopulation& population = network.populations[p];
    const std::uint32_t size = population.physics.size;
    image.populations.push_back({image.add_string(population.name), kNoString, next, size});
    for (std::uint32_t i = 0; i < size; ++i) {
      slots.population_of.push_back(p);
      slots.index_of.push_back(i);
    }
    next += size;
  }
  image.neuron_count = next;
  slots.first.resize(network.populations.size());
  for (const std::uint32_t p : order) {
    const TestPopulation& population = network.populations[p];
    GroupRecord group{};
    lower_model(population.physics, network.tick_ms, image, group);
    group.population = p;
    group.first_neuron = image.populations[p].first_neuron;
    group.size = population.physics.size;
    group.first_receptor = static_cast<std::uint32_t>(image.receptors.size());
    group.receptor_count = static_cast<std::uint32_t>(population.physics.receptors.size());
    group.first_slot = slots.first[p] = image.slot_count;
    image.slot_count += group.receptor_count * group.size;
    for (const ReceptorPhysics& receptor : population.physics.receptors) {
      image.receptors.push_back({image.add_string(receptor.name), receptor.kind, 0, receptor.window_ticks});
    }
    if (population.physics.model == ModelKind::SpikeList) {
      group.data_begin = static_cast<std::uint32_t>(image.source_spikes.size());
      group.data_count = static_cast<std::uint32_t>(2 * population.spikes.size());
      for (const auto& [tick, neuron] : population.spikes) {
        image.source_spikes.insert(image.source_spikes.end(), {tick, neuron});
      }
    }
    image.groups.push_back(group);
  }
}

struct LoweredSynapse {
  std::uint32_t pre, delay_ticks, slot;
  std::int32_t quanta;
  auto operator<=>(const LoweredSynapse&) const = default;
};

void add_segment(std::span<const LoweredSynapse> run, ImageContents& image) {
  const bool has_one_weight =
      std::all_of(run.begin(), run.end(), [&](const LoweredSynapse& s) { return s.quanta == run[0].quanta; });
  image.segments.push_back({run[0].delay_ticks, static_cast<std::uint32_t>(image.targets.size()),
                            static_cast<std::uint32_t>(image.weights.size()),
                            has_one_weight ? std::uint32_t{kSegmentOneWeight} : 0U});
  for (std::size_t k = 0; k < run.size(); ++k) {
    image.targets.push_back(run[k].slot);
    if (k == 0 || !has_one_weight) {
      image.weights.push_back(run[k].quanta);
    }
  }
  image.max_delay_ticks = std::max(image.max_delay_ticks, run[0].delay_ticks);
}

void add_rows(std::vector<LoweredSynapse> synapses, ImageContents& image) {
  std::sort(synapses.begin(), synapses.end());
  std::size_t next = 0;
  for (std::uint32_t neuron = 0; neuron < image.neuron_count; ++neuron) {
    image.row_begin.push_back(static_cast<std::uint32_t>(image.segments.size()));
    while (next < synapses.size() && synapses[next].pre == neuron) {
      std::size_t end = next;
      while (end < synapses.size() && synapses[end].pre == neuron &&
             synapses[end].delay_ticks == synapses[next].delay_ticks) {
        ++end;
      }
      add_segment(std::span(synapses).subspan(next, end - next), image);
      next = end;
    }
  }
  image.row_begin.push_back(static_cast<std::uint32_t>(image.segments.size()));
  image.segments.push_back(
      {0, static_cast<std::uint32_t>(image.targets.size()), static_cast<std::uint32_t>(image.weights.size()), 0});
}

}  // namespace

std::uint32_t TestNetwork::add(std::string name, ModelPhysics physics) {
  populations.push_back({std::move(name), std::move(physics), {}});
  return first_neuron(populations.size() - 1);
}

std::uint32_t TestNetwork::add_spikes(std::string name,
                                      const std::vector<std::vector<std::uint32_t>>& ticks_of_neuron) {
  TestPopulation population;
  population.name = std::move(name);
  population.physics.model = ModelKind::SpikeList;
  population.physics.size = static_cast<std::uint32_t>(ticks_of_neuron.size());
  for (std::uint32_t i = 0; i < ticks_of_neuron.size(); ++i) {
    for (const std::uint32_t tick : ticks_of_neuron[i]) {
      population.spikes.emplace_back(tick, i);
    }
  }
  std::sort(population.spikes.begin(), population.spikes.end());
  populations.push_back(std::move(population));
  return first_neuron(populations.size() - 1);
}

void TestNetwork::connect(std::uint32_t pre, std::uint32_t post, std::uint32_t delay_ticks, double weight,
                          std::uint32_t receptor) {
  synapses.push_back({pre, post, receptor, delay_ticks, weight});
}

std::uint32_t TestNetwork::first_neuron(std::size_t population) const {
  std::uint32_t first = 0;
  for (std::size_t p = 0; p < population; ++p) {
    first += populations[p].physics.size;
  }
  return first;
}

std::uint32_t TestNetwork::neuron_count() const { return first_neuron(populations.size()); }

ReceptorPhysics exponential(std::string name, double tau_ms) {
  return {std::move(name), ReceptorKind::Exponential, tau_ms, 0};
}
ReceptorPhysics instantaneous(std::string name) { return {std::move(name), ReceptorKind::Instantaneous, 0, 0}; }
ReceptorPhysics boxcar(std::string name, std::uint32_t window_ticks) {
  return {std::move(name), ReceptorKind::Boxcar, 0, window_ticks};
}

ImageContents lower_network(const TestNetwork& network) {
  ImageContents image;
  image.tick_ns = static_cast<std::uint64_t>(std::llround(network.tick_ms * 1e6));
  image.seed = network.seed;
  image.circuit_name = image.add_string("test");
  Slots slots;
  add_populations(network, image, slots);
  const std::vector<std::int32_t> quanta = choose_quanta(network, slots, image.slot_count);
  for (const GroupRecord& group : image.groups) {
    for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
      image.receptors[group.first_receptor + r].quantum_log2 = quanta[group.first_slot + r * group.size];
    }
  }
  std::vector<LoweredSynapse> synapses;
  synapses.reserve(network.synapses.size());
  for (const TestSynapse& synapse : network.synapses) {
    const std::uint32_t slot = slot_of(network, slots, synapse);
    const double scaled = std::ldexp(synapse.weight, -quanta[slot]);
    synapses.push_back({synapse.pre, synapse.delay_ticks, slot, static_cast<std::int32_t>(std::llround(scaled))});
  }
  add_rows(std::move(synapses), image);
  return image;
}

SpikeImage build_image(const TestNetwork& network) {
  LoadedImage loaded = load_image(write_image(lower_network(network)));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return std::move(*loaded.image);
}

Raster run_engine(SpikeEngine& engine, std::uint64_t ticks) {
  Raster raster;
  for (std::uint64_t t = 0; t < ticks; ++t) {
    engine.step();
    for (const NeuronId neuron : engine.spikes()) {
      raster.emplace_back(engine.tick() - 1, static_cast<std::uint32_t>(neuron));
    }
  }
  return raster;
}

Raster run_image(const SpikeImage& image, std::uint64_t ticks, const EngineOptions& options) {
  SpikeEngine engine(image, options);
  return run_engine(engine, ticks);
}

}  // namespace tectum::test
