// A small network as a list of populations and synapses, the image that it lowers to, and its raster.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "compiler/lower/lower_model.h"
#include "runtime/engine/spike_engine.h"
#include "runtime/image/image_contents.h"
#include "runtime/image/load_image.h"

namespace tectum::test {

struct TestPopulation {
  std::string name;
  ModelPhysics physics;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> spikes;  // (tick, neuron) of a spike_list
};

struct TestSynapse {
  std::uint32_t pre = 0;   // neuron of the network
  std::uint32_t post = 0;  // neuron of the network
  std::uint32_t receptor = 0;
  std::uint32_t delay_ticks = 1;
  double weight = 0;  // in the receptor's unit
};

struct TestNetwork {
  double tick_ms = 0.1;
  std::uint64_t seed = 1;
  std::vector<TestPopulation> populations;
  std::vector<TestSynapse> synapses;
  std::vector<std::uint32_t> update_order;  // population indices; empty: as listed

  /// Returns the first neuron of the new population.
  std::uint32_t add(std::string name, ModelPhysics physics);
  /// A spike_list population of one neuron for each given list of ticks.
  std::uint32_t add_spikes(std::string name, const std::vector<std::vector<std::uint32_t>>& ticks_of_neuron);
  void connect(std::uint32_t pre, std::uint32_t post, std::uint32_t delay_ticks, double weight,
               std::uint32_t receptor = 0);
  [[nodiscard]] std::uint32_t first_neuron(std::size_t population) const;
  [[nodiscard]] std::uint32_t neuron_count() const;
};

/// One receptor of each kind.
[[nodiscard]] ReceptorPhysics exponential(std::string name, double tau_ms);
[[nodiscard]] ReceptorPhysics instantaneous(std::string name);
[[nodiscard]] ReceptorPhysics boxcar(std::string name, std::uint32_t window_ticks);

/// Rows are sorted and segmented, rows of one weight store it once, and each receptor gets the
/// finest power-of-two quantum that keeps every slot's sum below 2^30.
[[nodiscard]] ImageContents lower_network(const TestNetwork& network);
/// Lowers, writes and loads. Fails the test if the image is refused.
[[nodiscard]] SpikeImage build_image(const TestNetwork& network);

using Raster = std::vector<std::pair<std::uint64_t, std::uint32_t>>;  // (tick, neuron), ascending

Raster run_engine(SpikeEngine& engine, std::uint64_t ticks);
[[nodiscard]] Raster run_image(const SpikeImage& image, std::uint64_t ticks, const EngineOptions& options = {});

}  // namespace tectum::test
