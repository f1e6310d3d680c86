// The controller of 2022: that it tracks, and that its coupling makes the lagging eye follow.
#include <doctest/doctest.h>

#include "tests/circuits/compiled_circuit.h"
#include "tools/analysis/simulated_run.h"
#include "tools/analysis/tracking_metrics.h"

using namespace tectum;

TEST_CASE("the controller of 2022 follows a jumping target") {
  const SpikeImage image = shipped_circuit("polykretis2022.json");
  SimulatedRunOptions options;
  options.head = fitted_to(image, options.head);
  options.head.scenario.kind = ScenarioKind::Random;
  options.head.seed = 1;
  options.duration_s = 8;
  const TrackingMetrics moving = tracking_metrics(run_simulated_head(image, options));
  const TrackingMetrics blind =
      tracking_metrics(run_simulated_head(shipped_circuit("polykretis2022.json", {}, {"SC"}), options));
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    CAPTURE(eye);
    CHECK(moving.eye[eye].pan.all.rmse_deg < 0.6 * blind.eye[eye].pan.all.rmse_deg);
    CHECK(moving.eye[eye].tilt.all.rmse_deg < 0.6 * blind.eye[eye].tilt.all.rmse_deg);
  }
}
