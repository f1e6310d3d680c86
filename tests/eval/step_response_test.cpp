#include "tools/evaluate/step_response.h"

#include <doctest/doctest.h>

using namespace tectum;

namespace {

/// A target that jumps from 0 to 10 deg at 1 s, and an eye sampled at 100 Hz for 3 s.
struct Trial {
  AngleTrace target, gaze;
  explicit Trial(double (*eye_deg)(double since_jump_s)) {
    for (int k = 0; k < 300; ++k) {
      const double time_s = k * 0.01;
      const bool has_jumped = k >= 100;
      target.time_s.push_back(time_s);
      target.pan_deg.push_back(has_jumped ? 10 : 0);
      target.tilt_deg.push_back(0);
      gaze.time_s.push_back(time_s);
      gaze.pan_deg.push_back(has_jumped ? eye_deg(time_s - 1) : 0);
      gaze.tilt_deg.push_back(0);
    }
  }
  [[nodiscard]] StepResponse step() const { return step_responses(gaze, target, {1.0}).at(0); }
};

}  // namespace

TEST_CASE("a step's latency, overshoot and settling time are those of its course") {
  // 10 % of the way 0.1 s after the jump, 12 deg at 0.2 s, back within 2 deg (11 deg) at 0.3 s.
  const StepResponse step = Trial([](double s) {
                              return s < 0.095 ? 0.0 : s < 0.195 ? 5.0 : s < 0.295 ? 12.5 : 11.0;
                            }).step();
  CHECK(step.size_deg == doctest::Approx(10));
  CHECK(step.latency_s == doctest::Approx(0.1));
  CHECK(step.overshoot_share == doctest::Approx(0.25));
  CHECK(step.has_settled);
  CHECK(step.settled_s == doctest::Approx(0.3));
}

TEST_CASE("an eye that never arrives has not settled, and one that falls short has no overshoot") {
  const StepResponse step = Trial([](double s) { return s < 0.5 ? 0.0 : 7.0; }).step();
  CHECK_FALSE(step.has_settled);
  CHECK(step.settled_s == doctest::Approx(1.99));
  CHECK(step.overshoot_share == 0);
}

TEST_CASE("the way is counted from where the eye was, not from where the target was") {
  Trial trial([](double) { return 10.0; });
  for (std::size_t k = 0; k < 100; ++k) {
    trial.gaze.pan_deg[k] = -10;  // had not arrived at the last target
  }
  CHECK(trial.step().overshoot_share == 0);
  CHECK(trial.step().latency_s == 0);
}
