#include "tools/evaluate/eye_plant.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/eval/evaluated_circuit.h"
#include "tools/evaluate/movement_trial.h"
#include "tools/evaluate/tracking_evaluation.h"

using namespace tectum;

TEST_CASE("the eye answers a step of the drive as two poles in a row do, whatever the size of the steps in time") {
  const auto [a_s, b_s] = kEyePlantPolesS;
  for (const double step_s : {0.0001, 0.0005, 0.002}) {
    CAPTURE(step_s);
    EyePlant plant(step_s, 2);
    for (int k = 1; k <= 100; ++k) {
      const double now_s = k * step_s;
      const double done = 1 - (a_s * std::exp(-now_s / a_s) - b_s * std::exp(-now_s / b_s)) / (a_s - b_s);
      CHECK(plant.step(12) == doctest::Approx(2 + 10 * done).epsilon(1e-9));
    }
  }
}

TEST_CASE("the eye follows a steady movement by the sum of its time constants behind, as fast as its drive") {
  constexpr double kStepS = 0.0005, kSpeedDegS = 100;
  EyePlant plant(kStepS);
  double before_deg = 0, now_deg = 0;
  for (int k = 1; k <= 1000; ++k) {
    before_deg = now_deg;
    now_deg = plant.step(kSpeedDegS * kStepS * (k - 0.5));  // the ramp's mean over the step
  }
  CHECK((now_deg - before_deg) / kStepS == doctest::Approx(kSpeedDegS));
  CHECK(1000 * kStepS - now_deg / kSpeedDegS == doctest::Approx(kEyePlantPolesS[0] + kEyePlantPolesS[1]).epsilon(1e-3));
}

TEST_CASE("a sharp pulse moves the eye by its area, and the eye comes back") {
  constexpr double kStepS = 0.0005;
  EyePlant plant(kStepS);
  double area_deg_s = 0, last_deg = 0;
  for (int k = 0; k < 1000; ++k) {
    last_deg = plant.step(k == 0 ? 40 : 0);
    area_deg_s += kStepS * last_deg;
  }
  CHECK(last_deg == doctest::Approx(0));
  CHECK(area_deg_s == doctest::Approx(40 * kStepS).epsilon(0.03));  // sampled at the ends of the steps
}

TEST_CASE("the eye comes to where the servos are sent, by a saccade with less noise than the command") {
  Protocol protocol = shipped_protocol("saccades");
  SimulatedRunOptions options = trial_options(oculomotor_image(), protocol, settings_of(protocol).front(), 0);
  options.head.scenario.kind = ScenarioKind::Path;
  options.head.scenario.path = {
      {0, place_m(-5, 0, 0.55), 0}, {2, place_m(-5, 0, 0.55), 0}, {2, place_m(5, 0, 0.55), 0}};
  options.duration_s = 4;
  const MovementTrial trial = run_movement(oculomotor_image(), options, nullptr);
  REQUIRE(trial.eye[0].time_s == trial.command[0].time_s);
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    for (const double from_s : {1.5, 3.5}) {
      CHECK(mean_between(trial.eye[eye], trial.eye[eye].pan_deg, from_s, from_s + 0.5) ==
            doctest::Approx(mean_between(trial.command[eye], trial.command[eye].pan_deg, from_s, from_s + 0.5))
                .epsilon(0.02));
    }
  }
  const auto trembling_deg = [](const AngleTrace& trace) {
    double sum = 0;
    for (std::size_t k = 751; k < 1000; ++k) {
      sum += std::abs(trace.pan_deg[k] - trace.pan_deg[k - 1]);
    }
    return sum;
  };
  CHECK(trembling_deg(trial.eye[0]) < 0.5 * trembling_deg(trial.command[0]));
}
