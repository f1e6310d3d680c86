// What is said of a recorded spike or movement holds against the recording.
#include "tools/diff/why.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/diff/edited_circuit.h"
#include "tools/analysis/simulated_run.h"
#include "tools/diff/battery.h"

using namespace tectum;

namespace {

Recording run_at(const CircuitView& view, const std::vector<PathPoint>& path, double duration_s) {
  Battery battery = make_battery({}, 1);
  battery.head.scenario.path = path;
  SimulatedRunOptions options = battery_options(view.image, battery);
  options.duration_s = duration_s;
  return run_simulated_head(view.image, options);
}

}  // namespace

TEST_CASE("a neuron's account from the spikes alone fires exactly when the engine did") {
  const CircuitView view = compiled_view(small_eye_text());
  const Recording recording = run_at(view, {{0, {0.06, 0.03}}}, 0.25);
  const SpikeTicks spikes = spike_ticks(recording.spikes, view.image.header.neuron_count);
  std::size_t checked = 0;
  for (const PopulationView& population : view.populations) {
    for (std::uint32_t i = 0; i < population.size; ++i) {
      const std::uint32_t neuron = population.first_neuron + i;
      const NeuronSetup setup = neuron_setup(view, spikes, neuron, 600);
      if (!account_of(setup, 1).has_potential) {
        continue;
      }
      for (std::uint32_t tick = 0; tick < 500; tick += 7) {
        CAPTURE(population.name);
        CAPTURE(tick);
        CHECK(account_of(setup, tick).fires() ==
              std::binary_search(setup.own_spikes.begin(), setup.own_spikes.end(), tick));
        ++checked;
      }
      for (const std::uint32_t tick : setup.own_spikes) {
        const NeuronAccount account = account_of(setup, tick);
        CHECK(account.fires());
        double sum = population.model == "threshold" ? 0 : account.own;
        for (const InputShare& share : account.shares) {
          sum += share.potential;
        }
        CHECK(sum == doctest::Approx(account.potential));
        ++checked;
      }
    }
  }
  CHECK(checked > 2000);
}

TEST_CASE("the mean input of a pathway is the mean of its input tick by tick") {
  const CircuitView view = compiled_view(small_eye_text());
  const Recording recording = run_at(view, {{0, {0.06, 0.03}}}, 0.1);
  const SpikeTicks spikes = spike_ticks(recording.spikes, view.image.header.neuron_count);
  for (const char* name : {"motor.left[1]", "gate.right[0]"}) {
    const NeuronSetup setup = neuron_setup(view, spikes, *find_neuron(view, name).neuron, 200);
    for (std::size_t k = 0; k < setup.inputs.size(); ++k) {
      double sum = 0;
      for (std::uint32_t tick = 150; tick < 170; ++tick) {
        sum += account_of(setup, tick).shares[k].input;
      }
      CHECK(mean_input(setup, setup.inputs[k], 150, 170) == doctest::Approx(sum / 20));
    }
  }
}

TEST_CASE("a saccade is led back from the motoneurons to what the retina saw") {
  const CircuitView view = compiled_view(oculomotor_text());
  const Recording recording = run_at(view, {{0.3, {0, 0}}, {0.3, {0.1, 0}}}, 0.6);
  // The frame in which the left eye's command moves most after the target's jump.
  double at_s = 0, most = 0;
  for (std::size_t k = 1; k < recording.frames.size(); ++k) {
    const double moved = recording.frames[k].goal_deg[0] - recording.frames[k - 1].goal_deg[0];
    if (recording.frames[k].time_ns > 300'000'000 && moved > most) {
      most = moved;
      at_s = static_cast<double>(recording.frames[k].time_ns) * 1e-9;
    }
  }
  const auto why = why_joint({recording, view}, Joint::LeftEyePan, at_s);
  REQUIRE(why.has_value());
  CHECK(why->is_moving);
  CHECK(why->output == "left_eye_pan");
  // Outer and inner cells of the motor map give half of the error each; which is first is the noise's. Inner ones fire
  // as much because outer cells drive them as because near cells no longer hold them back.
  const bool is_inner = why->hops.size() > 4 && why->hops[4].population == "SCm_inner.right";
  const bool is_released = is_inner && why->hops.size() > 5 && why->hops[5].population == "SCw_near.right";
  const std::vector<std::string> expected = {"MN_medial.left",
                                             "DSN.right",
                                             "EBN.right",
                                             "LLBN.right",
                                             is_inner ? "SCm_inner.right" : "SCm_outer.right",
                                             is_released ? "SCw_near.right" : "SCw_outer.right"};
  REQUIRE(why->hops.size() == expected.size() + 1);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    CHECK(why->hops[k].population == expected[k]);
    CHECK(why->hops[k + 1].time_s <= why->hops[k].time_s);
  }
  CHECK(why->hops.back().population.substr(0, 3) == "SC_");
  CHECK(why->hops.back().note.find("deg right") != std::string::npos);
}

TEST_CASE("an eye at rest is told by its rates, and a neuron that does not fire by what holds it down") {
  const CircuitView view = compiled_view(oculomotor_text());
  const Recording recording = run_at(view, {{0, {0, 0}}}, 0.5);
  const auto rest = why_joint({recording, view}, Joint::LeftEyePan, 0.48);
  REQUIRE(rest.has_value());
  CHECK_FALSE(rest->is_moving);
  CHECK(rest->hops.empty());
  double sum_deg = 0;
  for (const OutputShare& term : rest->terms) {
    sum_deg += term.gain * term.rate_hz;
  }
  CHECK(std::abs(sum_deg - rest->goal_deg) < 0.5);
  const NeuronWhy quiet = why_neuron({recording, view}, *find_neuron(view, "EBN.left[3]").neuron, 0.48);
  CHECK_FALSE(quiet.fires);
  CHECK(quiet.account.potential < quiet.account.threshold);
  REQUIRE_FALSE(quiet.shares.empty());
  const auto holds_down = std::min_element(quiet.shares.begin(), quiet.shares.end(), [](const auto& a, const auto& b) {
    return a.share.potential < b.share.potential;
  });
  CHECK(holds_down->projection == "opn_ebn");
  CHECK(holds_down->share.potential < -10);
}

TEST_CASE("a neuron that is not there is answered with what is") {
  const CircuitView view = compiled_view(small_eye_text());
  CHECK(find_neuron(view, "motor.left[4]").neuron.has_value());
  CHECK(find_neuron(view, "motor.left[5]").error == "motor.left has neurons 0 to 4, and no 5");
  CHECK(find_neuron(view, "motor[1]").error == "no population `motor`; there is motor.left or motor.right");
  CHECK(find_neuron(view, "motor.left").error == "`motor.left` names no neuron; write it as EBN.left[3]");
}
