// Scudder's saccade generator: the number of collicular spikes, not the time that they take, is the size of the
// saccade.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "runtime/engine/spike_engine.h"
#include "tests/circuits/compiled_circuit.h"
#include "tools/analysis/simulated_run.h"
#include "tools/analysis/tracking_metrics.h"

using namespace tectum;

namespace {

constexpr double kTickS = 1e-4;
constexpr double kGainDegS = 600;  // as the circuit file has it

struct Burst {
  double angle_deg = 0, held_deg = 0, peak_deg_s = 0, least_pause = 1, pause_at_end = 0;
};

/// What a burst by hand, at activity `strength` for `lasting_s`, does to blind eyes in 0.5 s.
Burst burst(double strength, double lasting_s, const std::vector<std::string>& lesions = {"eye"}) {
  const SpikeImage image = shipped_circuit(
      "scudder1988.json",
      {"burst_right=" + std::to_string(strength), "lasting=" + std::to_string(std::lround(lasting_s * 1e3)) + " ms"},
      lesions);
  const auto first = [&](const char* population) {
    return NeuronId{image.populations[image.find_population(population).value()].first_neuron};
  };
  SpikeEngine engine(image);
  const NeuronId right = first("EBN.right"), left = first("EBN.left"), tonic = first("TN.right"), pause = first("OPN");
  constexpr std::uint32_t kSecondState = 1;
  constexpr int kTicks = 5000;
  Burst result;
  for (int t = 0; t < kTicks; ++t) {
    engine.step();
    const double difference = engine.probe(right, kSecondState) - engine.probe(left, kSecondState);
    result.angle_deg += difference * kGainDegS * kTickS;
    result.peak_deg_s = std::max(result.peak_deg_s, difference * kGainDegS);
    result.pause_at_end = engine.probe(pause, kSecondState);
    result.least_pause = std::min(result.least_pause, result.pause_at_end);
  }
  constexpr double kRangeDeg = 120, kMiddle = 0.5;
  result.held_deg = (engine.probe(tonic, 0) - kMiddle) * kRangeDeg;
  return result;
}

}  // namespace

TEST_CASE("a saccade is as large as the colliculus fires spikes, however long it takes for them") {
  const Burst fast = burst(1, 0.05), slow = burst(0.25, 0.2);
  CHECK(std::abs(fast.angle_deg - slow.angle_deg) < 0.1 * fast.angle_deg);
  CHECK(slow.peak_deg_s < 0.5 * fast.peak_deg_s);
  const Burst half = burst(0.5, 0.05);
  CHECK(std::abs(2 * half.angle_deg - fast.angle_deg) < 0.1 * fast.angle_deg);
}

TEST_CASE("velocity saturates with amplitude, as the main sequence does") {
  const Burst small = burst(0.2, 0.03), middle = burst(1, 0.03), large = burst(3, 0.03);
  CHECK(middle.peak_deg_s / middle.angle_deg < small.peak_deg_s / small.angle_deg);
  CHECK(large.peak_deg_s / large.angle_deg < 0.7 * middle.peak_deg_s / middle.angle_deg);
  CHECK(large.peak_deg_s < 1.2 * kGainDegS);
}

TEST_CASE("the omnipause neurons are silent in the saccade and back after it, and TN holds what was done") {
  const Burst saccade = burst(0.5, 0.05);
  CHECK(saccade.least_pause < 0.01);
  CHECK(saccade.pause_at_end > 0.95);
  CHECK(std::abs(saccade.held_deg - saccade.angle_deg) < 0.05 * saccade.angle_deg);
}

TEST_CASE("without the local feedback the saccade does not end where it should") {
  const Burst intact = burst(0.5, 0.05), open = burst(0.5, 0.05, {"eye", "ibn_llbn"});
  CHECK(open.angle_deg > 2 * intact.angle_deg);
}

TEST_CASE("with eyes before it, the saccade generator of 1988 follows a jumping target") {
  const SpikeImage image = shipped_circuit("scudder1988.json");
  SimulatedRunOptions options;
  options.head = fitted_to(image, options.head);
  options.head.scenario.kind = ScenarioKind::Random;
  options.head.seed = 1;
  options.duration_s = 6;
  const TrackingMetrics moving = tracking_metrics(run_simulated_head(image, options));
  const TrackingMetrics blind =
      tracking_metrics(run_simulated_head(shipped_circuit("scudder1988.json", {}, {"eye"}), options));
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    CAPTURE(eye);
    CHECK(moving.eye[eye].pan.all.rmse_deg < 0.6 * blind.eye[eye].pan.all.rmse_deg);
    CHECK(moving.eye[eye].tilt.all.rmse_deg < 0.6 * blind.eye[eye].tilt.all.rmse_deg);
  }
}
