#include "tools/evaluate/tracking_evaluation.h"

#include <doctest/doctest.h>

#include "tests/eval/evaluated_circuit.h"
#include "tools/evaluate/evaluation_text.h"
#include "tools/evaluate/reference_run.h"

using namespace tectum;

namespace {

Protocol short_paper() {
  Protocol protocol = shipped_protocol("paper");
  protocol.trials = 2;
  protocol.duration_s = 4;
  protocol.hold_s = {1};
  return protocol;
}

double rmse_deg(const Recording& recording) { return tracking_metrics(recording).eye[0].pan.all.rmse_deg; }

}  // namespace

TEST_CASE("the oracle beats the PID servo's start values, and both beat eyes that stay where they are") {
  const SpikeImage& image = oculomotor_image();
  const Protocol protocol = shipped_protocol("paper");
  SimulatedRunOptions options = trial_options(image, protocol, {1, 3}, 2000);
  options.duration_s = 30;
  const double still = rmse_deg(run_reference(image, options, {ReferenceKind::Still, {}}));
  const double pid = rmse_deg(run_reference(image, options, {ReferenceKind::Pid, {0.1, 3, 0}}));
  const double oracle = rmse_deg(run_reference(image, options, {ReferenceKind::Oracle, {}}));
  CHECK(oracle < pid);
  CHECK(pid < still / 2);
}

TEST_CASE("a later camera costs the oracle tracking error") {
  const SpikeImage& image = oculomotor_image();
  const Protocol protocol = shipped_protocol("paper");
  SimulatedRunOptions at_once = trial_options(image, protocol, {1, 1}, 2000);
  at_once.duration_s = 30;
  SimulatedRunOptions late = at_once;
  late.head.camera_latency_frames = 3;
  const ReferenceController oracle{ReferenceKind::Oracle, {}};
  CHECK(rmse_deg(run_reference(image, late, oracle)) > 1.1 * rmse_deg(run_reference(image, at_once, oracle)));
}

TEST_CASE("an evaluation is the same for any number of threads, and another for other seeds") {
  const SpikeImage& image = oculomotor_image();
  Protocol protocol = short_paper();
  const std::string one = tracking_json(protocol, "c", evaluate_tracking(image, protocol, 1, nullptr));
  const std::string three = tracking_json(protocol, "c", evaluate_tracking(image, protocol, 3, nullptr));
  CHECK(one == three);
  protocol.first_seed = 50;
  protocol.camera_latency_frames = {1};
  const std::string other = tracking_json(protocol, "c", evaluate_tracking(image, protocol, 2, nullptr));
  CHECK(other != one);
}

TEST_CASE("circuit, oracle and PID servo follow the same target") {
  const SpikeImage& image = oculomotor_image();
  Protocol protocol = short_paper();
  protocol.camera_latency_frames = {1};
  const TrackingEvaluation evaluation = evaluate_tracking(image, protocol, 2, nullptr);
  const auto& controllers = evaluation.settings.at(0).controllers;
  for (std::size_t c = 1; c < kControllers; ++c) {
    const Recording& recording = controllers[c].first_trial;
    REQUIRE(recording.frames.size() == controllers[0].first_trial.frames.size());
    for (std::size_t k = 0; k < recording.frames.size(); ++k) {
      CHECK(recording.frames[k].target_on_wall_m == controllers[0].first_trial.frames[k].target_on_wall_m);
    }
  }
}

TEST_CASE("tuning finds the best point of its grid") {
  const SpikeImage& image = oculomotor_image();
  Protocol protocol = short_paper();
  protocol.camera_latency_frames = {1};
  protocol.tuning = {
      .first_seed = 1000, .trials = 1, .duration_s = 20, .hold_s = 1, .p = {0.2}, .i_hz = {0, 6}, .d_s = {0}};
  const std::vector<PidTuningResult> results = tune_pid(image, protocol, 2, nullptr);
  REQUIRE(results.size() == 1);
  CHECK(results[0].tuned.gains.i_hz == 6);  // without an integral a proportional servo stops half-way
  CHECK(results[0].tried == 2);
  CHECK(results[0].rmse_deg > results[0].oracle_rmse_deg);
}
