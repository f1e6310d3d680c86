// Gancarz & Grossberg's saccade generator: the spiking circuit against the paper's equations, and what the paper shows
// of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
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
constexpr double kTauS = 0.05;
constexpr double kStartS = 0.05;
constexpr double kDegPerBurst = 0.1 * 260 / kTauS;  // d theta / dt for a difference of 1 between both sides' E

/// What is done to the right side, from kStartS on, and to the omnipause neurons.
struct Stimulus {
  double llbn = 0, llbn_s = 0;
  double sc = 0, sc_s = 0, sc_weight = 1;
  double opn = 0, opn_from_s = 0, opn_to_s = 0;
};

/// Every 0.1 ms.
struct Trace {
  std::vector<double> burst, pause, angle_deg;  // E of the right side, g(P), theta

  void add(double e_right, double e_left, double gated) {
    burst.push_back(e_right);
    pause.push_back(gated);
    angle_deg.push_back((angle_deg.empty() ? 0 : angle_deg.back()) + (e_right - e_left) * kDegPerBurst * kTickS);
  }
};

double g(double x) { return std::pow(x, 4) / (std::pow(0.1, 4) + std::pow(x, 4)); }

/// The paper's equations for the horizontal pair, in double precision, by Euler steps of 10 us.
Trace integrated(const Stimulus& stimulus, double duration_s) {
  constexpr double kStepS = 1e-5;
  constexpr int kStepsPerTick = 10;
  const double h = kStepS / kTauS;
  std::array<double, 2> l{}, e{}, b{};
  double s = 0, p = 0.857;
  Trace trace;
  const auto ticks = static_cast<int>(std::lround(duration_s / kTickS));
  for (int k = 0; k < ticks * kStepsPerTick; ++k) {
    const double t = k * kStepS;
    const auto is_on = [&](double for_s) { return t >= kStartS && t < kStartS + for_s; };
    const double j = t >= stimulus.opn_from_s && t < stimulus.opn_to_s ? stimulus.opn : 0;
    s += h * (-s + (is_on(stimulus.sc_s) ? stimulus.sc : 0));
    const std::array<double, 2> drive = {
        0, (is_on(stimulus.llbn_s) ? stimulus.llbn : 0) + stimulus.sc_weight * std::min(1.0, s)};
    const std::array<double, 2> l0 = l, e0 = e, b0 = b;
    for (std::size_t side = 0; side < 2; ++side) {
      l[side] = std::max(0.0, l0[side] + h * (-1.3 * l0[side] + drive[side] - 2 * b0[side]));
      e[side] = std::max(0.0, e0[side] + h * (-3.5 * e0[side] + (2 - e0[side]) * (5 * l0[side] + 1) -
                                              (e0[side] + 1) * (10 * l0[1 - side] + 20 * g(p))));
      b[side] = std::max(0.0, b0[side] + h * (-2.4 * b0[side] + 3 * e0[side]));
    }
    p = std::max(0.0, p + h * (-0.2 * p + (1 - p) * (1.2 + j) - 3.5 * (p + 0.4) * (g(l0[0]) + g(l0[1]))));
    if (k % kStepsPerTick == 0) {
      trace.add(e[1], e[0], g(p));
    }
  }
  return trace;
}

/// The shipped circuit's states, read from the first neuron of each population.
Trace simulated(const Stimulus& stimulus, double duration_s) {
  const auto seconds = [](double value) { return std::to_string(value) + " s"; };
  const SpikeImage image =
      shipped_circuit("gancarz_grossberg1998.json",
                      {"llbn_right=" + std::to_string(stimulus.llbn), "llbn_from=" + seconds(kStartS),
                       "llbn_to=" + seconds(kStartS + stimulus.llbn_s), "sc_right=" + std::to_string(stimulus.sc),
                       "sc_from=" + seconds(kStartS), "sc_to=" + seconds(kStartS + stimulus.sc_s),
                       "W=" + std::to_string(stimulus.sc_weight), "opn=" + std::to_string(stimulus.opn),
                       "opn_from=" + seconds(stimulus.opn_from_s), "opn_to=" + seconds(stimulus.opn_to_s)},
                      {"eye"});
  const auto first = [&](const char* population) {
    return NeuronId{image.populations[image.find_population(population).value()].first_neuron};
  };
  SpikeEngine engine(image);
  const NeuronId right = first("EBN.right"), left = first("EBN.left"), pause = first("OPN");
  Trace trace;
  const auto ticks = static_cast<int>(std::lround(duration_s / kTickS));
  constexpr std::uint32_t kColumnOfP = 0;
  for (int t = 0; t < ticks; ++t) {
    engine.step();
    trace.add(engine.probe(right, 0), engine.probe(left, 0), g(engine.probe(pause, kColumnOfP)));
  }
  return trace;
}

struct Saccade {
  double start_s, end_s, amplitude_deg, peak_deg_s, least_pause;
};

/// Bursts of the right side above 0.1, 10 ms apart at least.
std::vector<Saccade> saccades(const Trace& trace) {
  constexpr double kActive = 0.1;
  constexpr std::size_t kGapTicks = 100;
  std::vector<Saccade> found;
  for (std::size_t t = 0; t < trace.burst.size(); ++t) {
    if (trace.burst[t] < kActive) {
      continue;
    }
    const std::size_t begin = t;
    for (std::size_t quiet = 0; t < trace.burst.size() && quiet < kGapTicks; ++t) {
      quiet = trace.burst[t] < kActive ? quiet + 1 : 0;
    }
    const std::size_t end = std::min(t, trace.burst.size() - 1);
    const auto at = [&](const std::vector<double>& values, std::size_t k) {
      return values.begin() + static_cast<std::ptrdiff_t>(k);
    };
    found.push_back({static_cast<double>(begin) * kTickS, static_cast<double>(end) * kTickS,
                     trace.angle_deg[end] - trace.angle_deg[begin],
                     *std::max_element(at(trace.burst, begin), at(trace.burst, end)) * kDegPerBurst,
                     *std::min_element(at(trace.pause, begin), at(trace.pause, end))});
  }
  return found;
}

}  // namespace

TEST_CASE("a lasting drive makes a staircase of equal saccades, with a pause of the omnipause neurons in each") {
  for (const double drive : {0.5, 1.0, 1.5}) {
    CAPTURE(drive);
    const Stimulus stimulus = {.llbn = drive, .llbn_s = 0.265};
    const std::vector<Saccade> steps = saccades(simulated(stimulus, 0.45));
    const std::vector<Saccade> published = saccades(integrated(stimulus, 0.45));
    REQUIRE(steps.size() == 3);
    REQUIRE(published.size() == 3);
    for (std::size_t k = 0; k < steps.size(); ++k) {
      CAPTURE(k);
      // The first begins from a higher level of the long-lead bursters' rest; the others are alike.
      CHECK(std::abs(steps[k].amplitude_deg - steps[1].amplitude_deg) < 0.2 * steps[1].amplitude_deg);
      CHECK(steps[k].least_pause < 0.05);
      CHECK(std::abs(steps[k].amplitude_deg - published[k].amplitude_deg) < 0.05 * published[k].amplitude_deg);
      CHECK(std::abs(steps[k].peak_deg_s - published[k].peak_deg_s) < 0.05 * published[k].peak_deg_s);
      CHECK(std::abs(steps[k].start_s - published[k].start_s) < 0.010);
    }
  }
}

TEST_CASE(
    "a shock to the omnipause neurons stops a saccade on its way, which then goes on and lands where it would have") {
  const Stimulus undisturbed = {.llbn = 1, .llbn_s = 0.1};
  Stimulus shocked = undisturbed;
  shocked.opn = 1.8;
  shocked.opn_from_s = kStartS + 0.045;
  shocked.opn_to_s = kStartS + 0.050;
  const Trace with = simulated(shocked, 0.3), without = simulated(undisturbed, 0.3);
  constexpr std::size_t kShock = 950, kAfter = 1080;
  const double on_the_way = with.angle_deg[kAfter];
  CHECK(with.burst[kShock] > 0.5);
  CHECK(*std::min_element(with.burst.begin() + kShock, with.burst.begin() + kAfter) < 0.05);
  CHECK(without.burst[kAfter] > 0.5);
  CHECK(on_the_way < 0.6 * without.angle_deg.back());
  CHECK(*std::max_element(with.burst.begin() + kAfter, with.burst.end()) > 0.5);
  CHECK(std::abs(with.angle_deg.back() - without.angle_deg.back()) < 0.1 * without.angle_deg.back());
  CHECK(std::abs(with.angle_deg.back() - integrated(shocked, 0.3).angle_deg.back()) < 0.05 * with.angle_deg.back());
}

TEST_CASE("as the colliculus is stimulated faster, amplitude saturates before peak velocity does") {
  std::vector<Saccade> by_frequency;
  for (const double frequency : {1.4, 1.8, 2.4}) {
    CAPTURE(frequency);
    const Stimulus stimulus = {.sc = frequency, .sc_s = 0.125, .sc_weight = 2};
    const std::vector<Saccade> found = saccades(simulated(stimulus, 0.175));
    const std::vector<Saccade> published = saccades(integrated(stimulus, 0.175));
    REQUIRE(!found.empty());
    REQUIRE(!published.empty());
    CHECK(std::abs(found[0].peak_deg_s - published[0].peak_deg_s) < 0.05 * published[0].peak_deg_s);
    by_frequency.push_back(found[0]);
  }
  const auto growth = [&](double Saccade::*figure) { return by_frequency[2].*figure / (by_frequency[0].*figure) - 1; };
  CHECK(growth(&Saccade::peak_deg_s) > 0.04);
  CHECK(std::abs(growth(&Saccade::amplitude_deg)) < 0.5 * growth(&Saccade::peak_deg_s));
}

TEST_CASE("at rest nothing bursts and the eyes stay where they are") {
  const Trace trace = simulated({}, 1);
  CHECK(*std::max_element(trace.burst.begin(), trace.burst.end()) < 0.01);
  CHECK(std::abs(trace.angle_deg.back()) < 0.01);
}

TEST_CASE("with eyes before it, the saccade generator of 1998 follows a jumping target") {
  const SpikeImage image = shipped_circuit("gancarz_grossberg1998.json");
  SimulatedRunOptions options;
  options.head = fitted_to(image, options.head);
  options.head.scenario.kind = ScenarioKind::Random;
  options.head.seed = 1;
  options.duration_s = 6;
  const TrackingMetrics moving = tracking_metrics(run_simulated_head(image, options));
  const TrackingMetrics blind =
      tracking_metrics(run_simulated_head(shipped_circuit("gancarz_grossberg1998.json", {}, {"eye"}), options));
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    CAPTURE(eye);
    CHECK(moving.eye[eye].pan.all.rmse_deg < 0.6 * blind.eye[eye].pan.all.rmse_deg);
    CHECK(moving.eye[eye].tilt.all.rmse_deg < 0.6 * blind.eye[eye].tilt.all.rmse_deg);
  }
}
