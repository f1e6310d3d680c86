// What comes from outside: fields, injections, Poisson trains, given spikes.
#include <doctest/doctest.h>

#include <cmath>

#include "runtime/image/philox.h"
#include "tests/support/test_network.h"

namespace tectum::test {
namespace {

TEST_CASE("Philox gives the published words") {
  // The known-answer vectors of the authors' own test (Random123, kat_vectors, philox4x32 10).
  CHECK(philox4x32(0, {0, 0, 0, 0}) == PhiloxWords{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  CHECK(philox4x32(0xffffffffffffffffULL, {0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}) ==
        PhiloxWords{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox4x32(0x299f31d0a4093822ULL, {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}) ==
        PhiloxWords{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("a field source fires at once when its field becomes active and then every period") {
  TestNetwork network;
  network.add("field", {ModelKind::FieldSource, 3, {{"rate", {1000.0}}}, {}, false});
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  Raster raster = run_engine(engine, 5);
  CHECK(raster.empty());
  engine.set_field_active(NeuronId{1}, true);
  for (int k = 0; k < 22; ++k) {
    engine.set_field_active(NeuronId{1}, true);  // said again, it changes nothing
    engine.step();
    for (const NeuronId neuron : engine.spikes()) {
      raster.emplace_back(engine.tick() - 1, static_cast<std::uint32_t>(neuron));
    }
  }
  CHECK(raster == Raster{{5, 1}, {15, 1}, {25, 1}});
  engine.set_field_active(NeuronId{1}, false);
  CHECK(run_engine(engine, 30).empty());
  engine.set_field_active(NeuronId{1}, true);
  CHECK(run_engine(engine, 5) == Raster{{57, 1}});
}

TEST_CASE("an injected spike is sent on like any other and does not reset its neuron") {
  TestNetwork network;
  network.add("lif", {ModelKind::LifExp, 2, {{"V_init", {-60.0}}}, {exponential("ex", 5)}, false});
  network.connect(0, 1, 3, 1.0);
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  engine.inject_spike(NeuronId{0});
  CHECK(run_engine(engine, 1) == Raster{{0, 0}});
  CHECK(engine.probe(NeuronId{0}, 0) > -60.1);
  CHECK(run_engine(engine, 3).empty());
  CHECK(engine.probe(NeuronId{1}, 1) == doctest::Approx(1));
}

TEST_CASE("a neuron that fires by itself and by injection in one tick fires once") {
  TestNetwork network;
  network.add_spikes("given", {{2}});
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  run_engine(engine, 2);
  engine.inject_spike(NeuronId{0});
  engine.inject_spike(NeuronId{0});
  CHECK(run_engine(engine, 3) == Raster{{2, 0}});
}

TEST_CASE("injected input counts in the next tick only, and too much is clipped and counted") {
  TestNetwork network;
  network.add("unit", {ModelKind::Threshold, 2, {{"theta", {1.0}}}, {instantaneous("now")}, false});
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  engine.inject_input(SlotId{1}, 0.5);
  engine.inject_input(SlotId{1}, 0.5);
  CHECK(run_engine(engine, 3) == Raster{{0, 1}});
  CHECK(engine.counters().saturated_inputs == 0);
  engine.inject_input(SlotId{0}, 1e30);
  engine.inject_input(SlotId{1}, std::nan(""));
  CHECK(run_engine(engine, 1) == Raster{{3, 0}});
  CHECK(engine.counters().saturated_inputs == 2);
}

TEST_CASE("Poisson sources keep their mean rate and differ from each other") {
  TestNetwork network;
  network.add("noise", {ModelKind::Poisson, 100, {{"rate", {40.0}}}, {}, false});
  network.add("strong", {ModelKind::Poisson, 2, {{"rate", {200.0, 0.0}}}, {}, false});
  constexpr std::uint64_t kTicks = 100'000;
  std::vector<double> count(102);
  for (const auto& [tick, neuron] : run_image(build_image(network), kTicks)) {
    ++count[neuron];
  }
  double sum = 0;
  double square = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    sum += count[i];
    square += count[i] * count[i];
  }
  const double mean = sum / 100;
  CHECK(mean == doctest::Approx(400).epsilon(0.02));                              // 5 standard errors are 2.5 %
  CHECK((square / 100 - mean * mean) / mean == doctest::Approx(1).epsilon(0.5));  // as many as a Poisson count varies
  CHECK(count[100] == doctest::Approx(2000).epsilon(0.1));
  CHECK(count[101] == 0);
}

TEST_CASE("a Poisson train depends on its population's name and the seed, not on its neighbours") {
  const auto train = [](const char* name, std::uint64_t seed, bool with_neighbour) {
    TestNetwork network;
    network.seed = seed;
    if (with_neighbour) {
      network.add("other", {ModelKind::Poisson, 7, {{"rate", {500.0}}}, {}, false});
    }
    const std::uint32_t first = network.add(name, {ModelKind::Poisson, 3, {{"rate", {500.0}}}, {}, false});
    Raster raster = run_image(build_image(network), 2000);
    std::erase_if(raster, [&](const auto& spike) { return spike.second < first; });
    for (auto& spike : raster) {
      spike.second -= first;
    }
    return raster;
  };
  CHECK(train("noise", 1, false) == train("noise", 1, true));
  CHECK(train("noise", 1, false) != train("noise", 2, false));
  CHECK(train("noise", 1, false) != train("hiss", 1, false));
}

TEST_CASE("a Poisson train is the same however many rates its group has, tabled or searched for") {
  const auto trains = [](std::size_t rates) {
    const std::vector<double> all{0.0, 1e-7, 0.3, 5.0, 20.0, 333.0, 4000.0, 10000.0, 17.0, 18.0, 19.0};
    TestNetwork network;
    network.add("noise", {ModelKind::Poisson,
                          static_cast<std::uint32_t>(rates),
                          {{"rate", {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(rates)}}},
                          {},
                          false});
    Raster raster = run_image(build_image(network), 60'000);
    std::erase_if(raster, [](const auto& spike) { return spike.second >= 8; });
    return raster;
  };
  const Raster tabled = trains(8);
  CHECK(tabled.size() > 80'000);
  CHECK(tabled == trains(11));
}

TEST_CASE("counters count ticks, spikes and synaptic events") {
  TestNetwork network;
  network.add_spikes("given", {{0, 1, 2}});
  network.add("unit", {ModelKind::Threshold, 4, {{"theta", {10.0}}}, {instantaneous("now")}, false});
  for (std::uint32_t i = 0; i < 4; ++i) {
    network.connect(0, 1 + i, 2 + i % 2, 1.0);
  }
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  run_engine(engine, 10);
  CHECK(engine.counters().ticks == 10);
  CHECK(engine.counters().spikes == 3);
  CHECK(engine.counters().synaptic_events == 12);
}

}  // namespace
}  // namespace tectum::test
