// When things happen: delays, order within a tick, refractoriness, the edges of each.
#include <doctest/doctest.h>

#include "runtime/image/models.h"
#include "tests/support/reference_simulator.h"

namespace tectum::test {
namespace {

// Fires in the tick in which a spike arrives.
ModelPhysics relay(std::uint32_t size = 1, double t_ref_ms = 0) {
  return {ModelKind::Threshold, size, {{"theta", {1.0}}, {"t_ref", {t_ref_ms}}}, {instantaneous("now")}, false};
}

std::vector<std::uint64_t> ticks_of(const Raster& raster, std::uint32_t neuron) {
  std::vector<std::uint64_t> ticks;
  for (const auto& [tick, n] : raster) {
    if (n == neuron) {
      ticks.push_back(tick);
    }
  }
  return ticks;
}

using Ticks = std::vector<std::uint64_t>;

TEST_CASE("a spike of tick s arrives in tick s + delay, for every delay") {
  for (const std::uint32_t delay : {0U, 1U, 2U, 7U, 63U, 64U, 65U, 1000U, 4096U, kMaxDelayTicks}) {
    CAPTURE(delay);
    TestNetwork network;
    network.add_spikes("source", {{0, 3, 10}});
    network.add("relay", relay());
    network.connect(0, 1, delay, 1.0);
    const Raster raster = run_image(build_image(network), 12 + delay);
    CHECK(ticks_of(raster, 1) == Ticks{delay, 3 + delay, 10 + delay});
  }
}

TEST_CASE("a row delivers each of its delays at its own tick") {
  TestNetwork network;
  network.add_spikes("source", {{5, 6}});
  network.add("relay", relay(5));
  const std::uint32_t delays[] = {0, 1, 2, 50, 3000};
  for (std::uint32_t k = 0; k < 5; ++k) {
    network.connect(0, 1 + k, delays[k], 1.0);
  }
  const Raster raster = run_image(build_image(network), 3100);
  for (std::uint32_t k = 0; k < 5; ++k) {
    CHECK(ticks_of(raster, 1 + k) == Ticks{5 + delays[k], 6 + delays[k]});
  }
}

TEST_CASE("a chain of same-tick synapses passes a spike on within the tick, in update order") {
  TestNetwork network;
  network.add("last", relay());
  network.add("middle", relay());
  network.add_spikes("source", {{4}});
  network.update_order = {2, 1, 0};
  network.connect(2, 1, 0, 1.0);
  network.connect(1, 0, 0, 1.0);
  CHECK(run_image(build_image(network), 10) == Raster{{4, 0}, {4, 1}, {4, 2}});
}

TEST_CASE("same-tick and delayed arrivals of one tick add up") {
  TestNetwork network;
  network.add_spikes("source", {{4}, {3}});
  network.add("and", {ModelKind::Threshold, 1, {{"theta", {2.0}}}, {instantaneous("now")}, false});
  network.connect(0, 2, 0, 1.0);
  network.connect(1, 2, 1, 1.0);
  CHECK(ticks_of(run_image(build_image(network), 10), 2) == Ticks{4});
}

TEST_CASE("simultaneous arrivals of both signs are summed before the threshold is looked at") {
  TestNetwork network;
  network.add_spikes("source", {{4, 8}, {4}});
  network.add("relay", relay());
  network.connect(0, 2, 2, 1.0);
  network.connect(1, 2, 2, -0.5);
  CHECK(ticks_of(run_image(build_image(network), 20), 2) == Ticks{10});
}

TEST_CASE("two synapses of one pair with the same delay both count") {
  TestNetwork network;
  network.add_spikes("source", {{4}});
  network.add("relay", relay());
  network.connect(0, 1, 3, 0.5);
  network.connect(0, 1, 3, 0.5);
  CHECK(ticks_of(run_image(build_image(network), 20), 1) == Ticks{7});
}

TEST_CASE("a boxcar window holds an arrival for exactly its ticks") {
  TestNetwork network;
  network.add_spikes("source", {{10}});
  network.add("box", {ModelKind::Threshold, 1, {{"theta", {1.0}}}, {boxcar("window", 4)}, false});
  network.connect(0, 1, 1, 1.0);
  CHECK(ticks_of(run_image(build_image(network), 30), 1) == Ticks{11, 12, 13, 14});
}

TEST_CASE("after a spike in tick s the next is possible in tick s + t_ref + 1") {
  for (const std::uint32_t refractory : {0U, 1U, 2U, 9U}) {
    CAPTURE(refractory);
    TestNetwork network;
    std::vector<std::uint32_t> every_tick(100);
    for (std::uint32_t t = 0; t < 100; ++t) {
      every_tick[t] = t;
    }
    network.add_spikes("source", {every_tick});
    network.add("relay", relay(1, 0.1 * refractory));
    network.add("delta", {ModelKind::LifDelta, 1, {{"t_ref", {0.1 * refractory}}}, {instantaneous("ex")}, false});
    network.connect(0, 1, 1, 1.0);
    network.connect(0, 2, 1, 100.0);
    const Raster raster = run_image(build_image(network), 40);
    for (const std::uint32_t neuron : {1U, 2U}) {
      const Ticks ticks = ticks_of(raster, neuron);
      REQUIRE(ticks.size() > 2);
      CHECK(ticks[0] == 1);
      CHECK(ticks[1] == 1 + refractory + 1);
      CHECK(ticks[2] == 1 + 2 * (refractory + 1));
    }
  }
}

TEST_CASE("input during the refractory period is lost to lif_delta, and one tick later it is not") {
  TestNetwork network;
  network.add_spikes("source", {{10, 12}, {10, 13}});
  network.add("delta", {ModelKind::LifDelta, 2, {{"t_ref", {0.2}}}, {instantaneous("ex")}, false});
  network.connect(0, 2, 0, 50.0);
  network.connect(1, 3, 0, 50.0);
  const Raster raster = run_image(build_image(network), 30);
  CHECK(ticks_of(raster, 2) == Ticks{10});
  CHECK(ticks_of(raster, 3) == Ticks{10, 13});
}

TEST_CASE("the currents of lif_exp go on while it is refractory") {
  TestNetwork network;
  network.add_spikes("source", {{10, 12}});
  network.add("lif", {ModelKind::LifExp, 1, {{"t_ref", {1.0}}}, {exponential("ex", 5)}, false});
  network.connect(0, 1, 1, 1000.0);
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  const Raster raster = run_engine(engine, 15);
  CHECK(ticks_of(raster, 1) == Ticks{12});
  CHECK(engine.probe(NeuronId{1}, 0) == doctest::Approx(-65));
  CHECK(engine.probe(NeuronId{1}, 1) > 1900);
}

TEST_CASE("an arrival moves the potential of lif_exp from the next tick on") {
  TestNetwork network;
  network.add_spikes("source", {{0}});
  network.add("lif", {ModelKind::LifExp, 1, {}, {exponential("ex", 5)}, false});
  network.connect(0, 1, 1, 1.0);
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  engine.step();
  engine.step();
  CHECK(engine.probe(NeuronId{1}, 0) == doctest::Approx(-70));
  CHECK(engine.probe(NeuronId{1}, 1) == doctest::Approx(1));
  engine.step();
  CHECK(engine.probe(NeuronId{1}, 0) > -70);
}

TEST_CASE("reset gives the same raster again") {
  TestNetwork network;
  network.add("noise", {ModelKind::Poisson, 20, {{"rate", {300.0}}}, {}, false});
  network.add("lif", {ModelKind::LifExp, 10, {}, {exponential("ex", 5)}, false});
  network.add("box", {ModelKind::Threshold, 5, {{"theta", {3.0}}}, {boxcar("window", 50)}, false});
  for (std::uint32_t k = 0; k < 200; ++k) {
    network.connect(k % 20, 20 + k % 15, 1 + k % 33, k % 15 < 10 ? 0.5 : 1.0);
  }
  const SpikeImage image = build_image(network);
  SpikeEngine engine(image);
  const Raster first = run_engine(engine, 3000);
  engine.inject_spike(NeuronId{25});
  engine.inject_input(SlotId{0}, 1.0);
  engine.reset();
  CHECK(engine.tick() == 0);
  CHECK(engine.spikes().empty());
  CHECK(run_engine(engine, 3000) == first);
  CHECK(ticks_of(first, 31).size() > 1);
}

}  // namespace
}  // namespace tectum::test
