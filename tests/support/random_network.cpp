#include "tests/support/random_network.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <random>

#include "runtime/image/program.h"
#include "tests/support/test_network.h"

namespace tectum::test {
namespace {

constexpr std::uint32_t kLongestTrainTicks = 400;

// The standard's distributions differ from library to library; its engine does not.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}
  /// In [low, high].
  std::uint32_t between(std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(engine_() % (std::uint64_t{high} - low + 1));
  }
  double real(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11U) * 0x1p-53);
  }
  bool one_in(std::uint32_t count) { return between(1, count) == 1; }

 private:
  std::mt19937_64 engine_;
};

ReceptorPhysics random_receptor(Draws& draws, bool only_exponential, std::uint32_t r) {
  const std::string name = "r" + std::to_string(r);
  if (only_exponential || draws.one_in(3)) {
    return exponential(name, draws.real(0.5, 50));
  }
  return draws.one_in(2) ? instantaneous(name) : boxcar(name, draws.between(1, 60));
}

std::vector<ReceptorPhysics> random_receptors(Draws& draws, std::uint32_t most, bool only_exponential) {
  std::vector<ReceptorPhysics> receptors;
  const std::uint32_t count = draws.between(1, most);
  for (std::uint32_t r = 0; r < count; ++r) {
    receptors.push_back(random_receptor(draws, only_exponential, r));
  }
  return receptors;
}

// One value, or one a neuron.
std::vector<double> random_values(Draws& draws, std::uint32_t size, double low, double high) {
  std::vector<double> values(draws.one_in(3) ? size : 1);
  for (double& value : values) {
    value = draws.real(low, high);
  }
  return values;
}

double whole_ticks_ms(Draws& draws, std::uint32_t most_ticks) { return 0.1 * draws.between(0, most_ticks); }

ModelPhysics random_membrane(Draws& draws, ModelKind model, std::uint32_t size) {
  ModelPhysics physics;
  physics.model = model;
  physics.size = size;
  // Every third population rests above its threshold now and then: it never sleeps, or only some of it does.
  physics.parameters = {{"tau_m", {draws.real(2, 40)}},
                        {"E_L", {-70}},
                        {"V_th", random_values(draws, size, draws.one_in(3) ? -72 : -60, -50)},
                        {"V_reset", {draws.real(-75, -62)}},
                        {"V_init", random_values(draws, size, -75, -50)},
                        {"t_ref", {whole_ticks_ms(draws, 60)}},
                        {"R_m", {10}}};
  if (draws.one_in(3)) {
    physics.parameters["I_bias"] = random_values(draws, size, -0.5, 2.5);
  }
  if (model == ModelKind::Alif) {
    physics.parameters["tau_w"] = {draws.real(20, 200)};
    physics.parameters["b_w"] = {draws.real(0, 0.3)};
  }
  if (model == ModelKind::LifDelta) {
    for (std::uint32_t r = 0; r < draws.between(1, 3); ++r) {
      physics.receptors.push_back(instantaneous("r" + std::to_string(r)));
    }
  } else {
    physics.receptors = random_receptors(draws, 4, true);
  }
  physics.may_sleep = !draws.one_in(3);
  return physics;
}

ModelPhysics random_physics(Draws& draws, std::uint32_t size) {
  constexpr ModelKind kModels[] = {ModelKind::LifExp,     ModelKind::LifExp,    ModelKind::LifDelta, ModelKind::Alif,
                                   ModelKind::Izhikevich, ModelKind::Threshold, ModelKind::Poisson};
  const ModelKind model = kModels[draws.between(0, static_cast<std::uint32_t>(std::size(kModels)) - 1)];
  ModelPhysics physics;
  physics.model = model;
  physics.size = size;
  switch (model) {
    case ModelKind::Izhikevich:
      physics.parameters = {{"d", random_values(draws, size, 1, 8)}, {"I_bias", {draws.real(0, 12)}}};
      physics.receptors = random_receptors(draws, 3, false);
      return physics;
    case ModelKind::Threshold:
      physics.parameters = {{"theta", random_values(draws, size, 0.5, 4)}, {"t_ref", {whole_ticks_ms(draws, 30)}}};
      physics.receptors = random_receptors(draws, 2, false);
      for (ReceptorPhysics& receptor : physics.receptors) {
        receptor = receptor.kind == ReceptorKind::Exponential ? boxcar(receptor.name, 7) : receptor;
      }
      return physics;
    case ModelKind::Poisson:
      physics.parameters = {{"rate", random_values(draws, size, 0, 300)}};
      return physics;
    default:
      return random_membrane(draws, model, size);
  }
}

void add_trains(Draws& draws, TestNetwork& network) {
  std::vector<std::vector<std::uint32_t>> trains(draws.between(1, 20));
  for (std::vector<std::uint32_t>& train : trains) {
    for (std::uint32_t tick = draws.between(0, 20); tick < kLongestTrainTicks; tick += draws.between(1, 80)) {
      train.push_back(tick);
    }
  }
  network.add_spikes("trains", trains);
}

// A weight of which a few make a spike.
double strong_weight(ModelKind model) {
  switch (model) {
    case ModelKind::LifDelta:
      return 8;
    case ModelKind::Izhikevich:
      return 20;
    case ModelKind::Threshold:
      return 1;
    default:
      return 3;
  }
}

std::uint32_t random_delay(Draws& draws, std::uint32_t shortest) {
  switch (draws.between(0, 7)) {
    case 0:
      return std::max(shortest, 1U);
    case 1:
      return draws.between(shortest, 3000);
    case 2:
    case 3:
      return draws.between(shortest, 150);
    default:
      return draws.between(shortest, 24);
  }
}

void wire(Draws& draws, TestNetwork& network) {
  const bool has_same_tick = draws.one_in(4);
  const std::uint32_t shortest_delay = draws.between(1, 20);
  const auto count = static_cast<std::uint32_t>(network.populations.size());
  for (std::uint32_t projection = 0; projection < 3 * count; ++projection) {
    const std::uint32_t from = draws.between(0, count - 1);
    const std::uint32_t to = draws.between(0, count - 1);
    const ModelPhysics& target = network.populations[to].physics;
    if (target.receptors.empty()) {
      continue;
    }
    const bool has_one_weight = draws.one_in(3);
    const std::uint32_t shortest = has_same_tick && from < to ? 0 : shortest_delay;
    const std::uint32_t one_delay = random_delay(draws, shortest);
    const bool has_one_delay = draws.one_in(2);
    const auto receptor = draws.between(0, static_cast<std::uint32_t>(target.receptors.size()) - 1);
    const double sign = draws.one_in(3) ? -1 : 1;
    const std::uint32_t synapses = network.populations[from].physics.size * draws.between(1, 6);
    for (std::uint32_t s = 0; s < synapses; ++s) {
      const std::uint32_t pre = draws.between(0, network.populations[from].physics.size - 1);
      const std::uint32_t post = draws.between(0, target.size - 1);
      const double scale = has_one_weight ? 1.0 : draws.real(0.2, 1.5);
      network.connect(network.first_neuron(from) + pre, network.first_neuron(to) + post,
                      has_one_delay ? one_delay : random_delay(draws, shortest),
                      sign * scale * strong_weight(target.model), receptor);
    }
  }
}

// v = v * decay + input;  fires: threshold <= v;  v = reset;  held for 3 ticks. In place of an Izhikevich group
// with one receptor.
void make_program(ImageContents& image, GroupRecord& group) {
  constexpr std::uint32_t kV = 0, kInput = 1, kDecay = 2, kThreshold = 3, kReset = 4, kFires = 5;
  const ProgramHeader header{kProgramVersion, 1, 1, 0, 3, 1, 1, 1, 1, kFires, 3, 1};
  const ProgramStep steps[] = {{ProgramOp::MultiplyAdd, kV, kV, kDecay, kInput},
                               {ProgramOp::LessEqual, kFires, kThreshold, kV, 0},
                               {ProgramOp::Copy, kV, kReset, 0, 0}};
  const std::vector<double> receptor(image.parameters.begin() + group.parameter_begin + group.parameter_count - 2,
                                     image.parameters.begin() + group.parameter_begin + group.parameter_count);
  group.model = ModelKind::Program;
  group.flags = 0;
  group.column_begin = static_cast<std::uint32_t>(image.columns.size());
  group.column_count = 0;
  group.parameter_begin = static_cast<std::uint32_t>(image.parameters.size());
  image.parameters.insert(image.parameters.end(), {0.97, 60.0, -5.0, receptor[0], receptor[1]});
  group.parameter_count = 5;
  group.data_begin = static_cast<std::uint32_t>(image.programs.size());
  const auto head = std::bit_cast<std::array<std::uint32_t, kProgramHeaderWords>>(header);
  image.programs.insert(image.programs.end(), head.begin(), head.end());
  image.programs.push_back(kReset);  // v begins there
  for (const ProgramStep& step : steps) {
    image.programs.insert(image.programs.end(),
                          {static_cast<std::uint32_t>(step.op), step.target, step.a, step.b, step.c});
  }
  group.data_count = static_cast<std::uint32_t>(image.programs.size()) - group.data_begin;
}

}  // namespace

ImageContents random_image(std::uint64_t seed) {
  Draws draws(seed);
  TestNetwork network;
  network.seed = seed;
  add_trains(draws, network);
  const bool is_large = seed % 32 == 31;
  const std::uint32_t populations = draws.between(1, is_large ? 2 : 5);
  for (std::uint32_t p = 0; p < populations; ++p) {
    const std::uint32_t size = is_large ? draws.between(4000, 17000) : draws.between(1, draws.one_in(3) ? 400 : 70);
    network.add("p" + std::to_string(p), random_physics(draws, size));
  }
  wire(draws, network);
  ImageContents image = lower_network(network);
  const bool makes_programs = draws.one_in(2);
  for (GroupRecord& group : image.groups) {
    if (makes_programs && group.model == ModelKind::Izhikevich && group.receptor_count == 1) {
      make_program(image, group);
    }
  }
  return image;
}

}  // namespace tectum::test
