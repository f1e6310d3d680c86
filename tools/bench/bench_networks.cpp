#include "tools/bench/bench_networks.h"

#include <cmath>

#include "compiler/lower/lower_model.h"
#include "tools/bench/row_builder.h"

namespace tectum::bench {
namespace {

constexpr double kTickMs = 0.1;
constexpr std::int32_t kQuantumLog2 = -18;  // 2^-18 mV: a slot's weights can sum to 4096 mV

std::int32_t quanta(double weight_mv) {
  return static_cast<std::int32_t>(std::llround(std::ldexp(weight_mv, -kQuantumLog2)));
}

ImageContents empty_image(std::string_view name, std::uint64_t seed) {
  ImageContents image;
  image.tick_ns = 100'000;
  image.seed = seed;
  image.circuit_name = image.add_string(name);
  return image;
}

// One population in one group. Returns the group's first slot.
std::uint32_t add_population(ImageContents& image, std::string_view name, const ModelPhysics& physics) {
  const auto p = static_cast<std::uint32_t>(image.populations.size());
  image.populations.push_back({image.add_string(name), kNoString, image.neuron_count, physics.size});
  GroupRecord group{};
  lower_model(physics, kTickMs, image, group);
  group.population = p;
  group.first_neuron = image.neuron_count;
  group.size = physics.size;
  group.first_receptor = static_cast<std::uint32_t>(image.receptors.size());
  group.receptor_count = static_cast<std::uint32_t>(physics.receptors.size());
  group.first_slot = image.slot_count;
  for (const ReceptorPhysics& receptor : physics.receptors) {
    image.receptors.push_back({image.add_string(receptor.name), receptor.kind, kQuantumLog2, receptor.window_ticks});
  }
  image.groups.push_back(group);
  image.neuron_count += physics.size;
  image.slot_count += group.receptor_count * physics.size;
  return group.first_slot;
}

// R_m = 1 MOhm, so that a weight of 1 nA is the 1 mV of the network's definition.
ModelPhysics membrane(std::uint32_t size) {
  ModelPhysics physics;
  physics.model = ModelKind::LifExp;
  physics.size = size;
  physics.parameters = {{"tau_m", {20}}, {"R_m", {1}},       {"E_L", {-49}},
                        {"V_th", {-50}}, {"V_reset", {-60}}, {"t_ref", {5}}};
  physics.receptors = {{"ex", ReceptorKind::Exponential, 5, 0}, {"in", ReceptorKind::Exponential, 10, 0}};
  return physics;
}

std::vector<double> uniform_values(SplitMix& random, std::uint32_t count, double low, double high) {
  std::vector<double> values(count);
  for (double& value : values) {
    value = low + (high - low) * random.uniform();
  }
  return values;
}

// Vogels & Abbott 2005, doi:10.1523/JNEUROSCI.3508-05.2005, current-based; as in Brette et al. 2007.
ImageContents cuba(std::string_view name, std::uint32_t size, double probability, bool has_own_weights) {
  ImageContents image = empty_image(name, 1);
  SplitMix random(12345);
  ModelPhysics physics = membrane(size);
  physics.parameters["V_init"] = uniform_values(random, size, -60, -50);
  add_population(image, "neurons", physics);
  const std::uint32_t excitatory = size / 5 * 4;
  std::vector<RowSynapse> row;
  for (std::uint32_t pre = 0; pre < size; ++pre) {
    row.clear();
    // Geometric jumps from target to target.
    const double log_miss = std::log1p(-probability);
    for (double post = std::floor(std::log1p(-random.uniform()) / log_miss); post < size;
         post += 1 + std::floor(std::log1p(-random.uniform()) / log_miss)) {
      const bool is_excitatory = pre < excitatory;
      const double scale = has_own_weights ? 0.5 + random.uniform() : 1.0;
      row.push_back({static_cast<std::uint32_t>(post) + (is_excitatory ? 0 : size),
                     quanta((is_excitatory ? 1.62 : -9.0) * scale)});
    }
    append_row(row, 8, image);
  }
  finish_rows(image);
  return image;
}

ImageContents cuba_4k() { return cuba("cuba_4k", 4000, 0.02, false); }
ImageContents cuba_40k() { return cuba("cuba_40k", 40000, 0.002, true); }

ImageContents silent_100k() {
  constexpr std::uint32_t kSize = 100'000;
  constexpr std::uint32_t kDriven = 500;
  constexpr std::uint32_t kInDegree = 100;
  ImageContents image = empty_image("silent_100k", 2);
  SplitMix random(777);
  ModelPhysics physics = membrane(kSize);
  physics.parameters["E_L"] = {-65};
  physics.may_sleep = true;
  physics.receptors.resize(1);
  add_population(image, "neurons", physics);
  ModelPhysics trains;
  trains.model = ModelKind::Poisson;
  trains.size = kDriven;
  trains.parameters["rate"] = {50};
  add_population(image, "trains", trains);
  // Each neuron has kInDegree inputs from anywhere.
  std::vector<std::vector<RowSynapse>> rows(kSize);
  for (std::uint32_t post = 0; post < kSize; ++post) {
    for (std::uint32_t k = 0; k < kInDegree; ++k) {
      rows[random.below(kSize)].push_back({post, quanta(1.62 * (0.5 + random.uniform()))});
    }
  }
  for (std::vector<RowSynapse>& row : rows) {
    append_row(row, 8, image);
  }
  for (std::uint32_t train = 0; train < kDriven; ++train) {
    std::vector<RowSynapse> row = {{train * (kSize / kDriven), quanta(150)}};  // one spike each
    append_row(row, 8, image);
  }
  finish_rows(image);
  return image;
}

// The loop of an eye-movement controller: one millisecond at a time, spikes read out each time.
ImageContents loop_2k() {
  constexpr std::uint32_t kInputs = 1500;
  constexpr std::uint32_t kInhibitory = 300;
  constexpr std::uint32_t kExcitatory = 200;
  ImageContents image = empty_image("loop_2k", 3);
  SplitMix random(4242);
  ModelPhysics inputs;
  inputs.model = ModelKind::Poisson;
  inputs.size = kInputs;
  inputs.parameters["rate"] = {20};
  add_population(image, "inputs", inputs);
  ModelPhysics physics = membrane(kInhibitory);
  physics.parameters["E_L"] = {-65};
  const std::uint32_t inhibitory = add_population(image, "inhibitory", physics);
  physics.size = kExcitatory;
  const std::uint32_t excitatory = add_population(image, "excitatory", physics);
  std::vector<std::vector<RowSynapse>> rows(image.neuron_count);
  const auto connect = [&](std::uint32_t first_pre, std::uint32_t pre_count, std::uint32_t first_slot,
                           std::uint32_t post_count, std::uint32_t in_degree, double weight_mv) {
    for (std::uint32_t post = 0; post < post_count; ++post) {
      for (std::uint32_t k = 0; k < in_degree; ++k) {
        rows[first_pre + random.below(pre_count)].push_back({first_slot + post, quanta(weight_mv)});
      }
    }
  };
  connect(0, kInputs, inhibitory, kInhibitory, 100, 1.6);
  connect(0, kInputs, excitatory, kExcitatory, 150, 1.6);
  connect(kInputs, kInhibitory, excitatory + kExcitatory, kExcitatory, 30, -1.0);
  connect(kInputs + kInhibitory, kExcitatory, excitatory, kExcitatory, 20, 0.6);
  connect(kInputs + kInhibitory, kExcitatory, inhibitory, kInhibitory, 20, 0.6);
  for (std::vector<RowSynapse>& row : rows) {
    append_row(row, 10, image);
  }
  finish_rows(image);
  return image;
}

}  // namespace

const std::vector<BenchNetwork>& bench_networks() {
  static const std::vector<BenchNetwork> networks = {
      {"cuba_4k", "4000 LIF, all awake", 10, 0, cuba_4k},
      {"cuba_40k", "40 000 LIF, own weights", 10, 0, cuba_40k},
      {"silent_100k", "100 000 LIF, nearly all asleep", 10, 0, silent_100k},
      {"loop_2k", "2000 neurons, read out every 1 ms", 10, 10, loop_2k},
  };
  return networks;
}

}  // namespace tectum::bench
