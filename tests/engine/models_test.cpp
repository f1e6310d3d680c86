// Every built-in model against a plain double-precision reference, spike for spike.
#include <doctest/doctest.h>

#include <cmath>

#include "runtime/image/models.h"
#include "tests/support/reference_simulator.h"

namespace tectum::test {
namespace {

// A regular input train of `count` neurons with periods that never fall into step.
std::uint32_t add_trains(TestNetwork& network, std::uint32_t count, std::uint32_t ticks) {
  std::vector<std::vector<std::uint32_t>> trains(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t tick = 5 + 3 * i; tick < ticks; tick += 23 + 7 * i) {
      trains[i].push_back(tick);
    }
  }
  return network.add_spikes("trains", trains);
}

// Every train reaches every neuron with its own weight and delay, on alternating receptors.
TestNetwork driven(ModelPhysics physics, double weight, std::uint32_t ticks) {
  constexpr std::uint32_t kTrains = 8;
  TestNetwork network;
  const std::uint32_t first_train = add_trains(network, kTrains, ticks);
  const std::uint32_t size = physics.size;
  const auto receptors = static_cast<std::uint32_t>(physics.receptors.size());
  const std::uint32_t first = network.add("driven", std::move(physics));
  for (std::uint32_t i = 0; i < size; ++i) {
    for (std::uint32_t k = 0; k < kTrains; ++k) {
      const std::uint32_t receptor = k % receptors;
      const double sign = receptors > 1 && receptor == receptors - 1 ? -0.5 : 1.0;
      // Multiples of 1/64 are exact in quanta, so that the reference sums the same numbers.
      const double exact = std::round(weight * (1 + 0.1 * i + 0.05 * k) * 64) / 64;
      network.connect(first_train + k, first + i, 1 + (i + 3 * k) % 40, sign * exact, receptor);
    }
  }
  return network;
}

void expect_agreement(const TestNetwork& network, std::uint64_t ticks, double tolerance_mv) {
  const ReferenceRun reference = run_reference(network, ticks);
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  Raster raster;
  double worst_mv = 0;
  for (std::uint64_t t = 0; t < ticks; ++t) {
    engine.step();
    for (const NeuronId neuron : engine.spikes()) {
      raster.emplace_back(t, static_cast<std::uint32_t>(neuron));
    }
    for (std::uint32_t n = 0; n < network.neuron_count(); ++n) {
      if (find_model(image.groups[n < 8 ? 0 : 1].model)->states.size() > 0 && reference.v_mv[t][n] != 0) {
        worst_mv = std::max(worst_mv, std::abs(engine.probe(NeuronId{n}, 0) - reference.v_mv[t][n]));
      }
    }
  }
  CHECK(raster == reference.raster);
  CHECK(worst_mv < tolerance_mv);
  // The trains alone do not count: the driven neurons must have fired for this to mean anything.
  std::size_t driven_spikes = 0;
  for (const auto& [tick, neuron] : raster) {
    driven_spikes += neuron >= 8 ? 1 : 0;
  }
  CHECK(driven_spikes > 20);
}

constexpr std::uint32_t kTicks = 6000;

TEST_CASE("lif_exp agrees with the reference spike for spike") {
  expect_agreement(
      driven({ModelKind::LifExp, 9, {{"t_ref", {2.0}}}, {exponential("ex", 5), exponential("in", 10)}, false}, 3.0,
             kTicks),
      kTicks, 1e-3);
}

TEST_CASE("lif_exp with equal time constants of membrane and synapse agrees with the reference") {
  expect_agreement(driven({ModelKind::LifExp, 5, {{"tau_m", {10.0}}}, {exponential("ex", 10)}, false}, 0.5, kTicks),
                   kTicks, 1e-3);
}

TEST_CASE("lif_exp with four receptors agrees with the reference") {
  expect_agreement(
      driven({ModelKind::LifExp,
              4,
              {{"t_ref", {0.0}}},
              {exponential("ampa", 2), exponential("nmda", 80), exponential("mid", 7), exponential("gaba", 9)},
              false},
             0.7, kTicks),
      kTicks, 1e-2);
}

TEST_CASE("neurons of one group may differ in bias, threshold and start") {
  expect_agreement(driven({ModelKind::LifExp,
                           3,
                           {{"I_bias", {0.0, 0.5, 1.9}}, {"V_th", {-55, -50, -49}}, {"V_init", {-70, -60, -52}}},
                           {exponential("ex", 5)},
                           false},
                          0.6, kTicks),
                   kTicks, 1e-3);
}

TEST_CASE("a suprathreshold bias fires a neuron without input at the analytic times") {
  TestNetwork network;
  network.add("lif", {ModelKind::LifExp, 1, {{"I_bias", {3.0}}, {"t_ref", {0.5}}}, {exponential("ex", 5)}, false});
  const Raster raster = run_image(build_image(network), 3000);
  // From -70 mV towards -40 mV: -50 mV is crossed at tau_m ln(30/10) = 21.97 ms, so in tick 219
  // (the state after 220 ticks); from the reset at -65 mV after tau_m ln(25/10) = 18.33 ms more,
  // counted from the end of the 5 refractory ticks.
  REQUIRE(raster.size() > 3);
  CHECK(raster[0].first == 219);
  CHECK(raster[1].first == 219 + 5 + 184);
  CHECK(raster[2].first == 219 + 2 * (5 + 184));
}

TEST_CASE("lif_delta agrees with the reference spike for spike") {
  expect_agreement(driven({ModelKind::LifDelta, 7, {}, {instantaneous("ex"), instantaneous("in")}, false}, 9.0, kTicks),
                   kTicks, 1e-3);
}

TEST_CASE("alif adapts as the reference does") {
  expect_agreement(
      driven({ModelKind::Alif, 6, {{"b_w", {0.25}}, {"tau_w", {120.0}}}, {exponential("ex", 5)}, false}, 1.0, kTicks),
      kTicks, 1e-3);
}

// Sleeping neurons leap in closed form; the reference integrates every tick of them.
TEST_CASE("neurons that may sleep agree with the reference spike for spike") {
  for (const bool is_sparse : {false, true}) {
    const std::vector<double> theta = is_sparse ? std::vector{-50.0} : std::vector{-50.0, -58.0, -69.0, -71.0, -45.0};
    expect_agreement(
        driven({ModelKind::LifExp, 5, {{"V_th", theta}}, {exponential("ex", 5), exponential("in", 10)}, true}, 3.0,
               kTicks),
        kTicks, 1e-3);
    expect_agreement(
        driven({ModelKind::LifDelta, 5, {{"V_th", theta}}, {instantaneous("ex"), instantaneous("in")}, true}, 9.0,
               kTicks),
        kTicks, 1e-3);
    expect_agreement(driven({ModelKind::Alif, 5, {{"V_th", theta}}, {exponential("ex", 5)}, true}, 1.0, kTicks), kTicks,
                     1e-3);
  }
}

TEST_CASE("izhikevich agrees with the reference spike for spike, for each kind of receptor") {
  for (const ReceptorPhysics& receptor : {instantaneous("a"), exponential("b", 5), boxcar("c", 20)}) {
    CAPTURE(receptor.name);
    expect_agreement(driven({ModelKind::Izhikevich, 5, {{"d", {8, 2, 4, 6, 8}}}, {receptor}, false},
                            receptor.kind == ReceptorKind::Instantaneous ? 100 : 4, kTicks),
                     kTicks, 1e-9);
  }
}

TEST_CASE("izhikevich with rectified input and a slowed clock agrees with the reference") {
  expect_agreement(driven({ModelKind::Izhikevich,
                           4,
                           {{"rectify", {1.0}}, {"time_scale", {0.25}}, {"V_peak", {25.0}}, {"I_bias", {6.0}}},
                           {instantaneous("ex"), instantaneous("in")},
                           false},
                          150, kTicks),
                   kTicks, 1e-9);
}

TEST_CASE("threshold units agree with the reference") {
  expect_agreement(
      driven({ModelKind::Threshold, 6, {{"theta", {2.0}}, {"t_ref", {1.5}}}, {boxcar("window", 30)}, false}, 0.5,
             kTicks),
      kTicks, 1e-9);
  expect_agreement(driven({ModelKind::Threshold, 6, {{"theta", {1.0}}}, {instantaneous("now")}, false}, 0.75, kTicks),
                   kTicks, 1e-9);
}

}  // namespace
}  // namespace tectum::test
