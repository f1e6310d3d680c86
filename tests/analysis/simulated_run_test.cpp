#include "tools/analysis/simulated_run.h"

#include <doctest/doctest.h>

#include "tests/loop/loop_fixture.h"

using namespace tectum;

namespace {

Recording one_second(double sample_rate_hz) {
  SimulatedRunOptions options;
  options.duration_s = 1;
  options.sample_rate_hz = sample_rate_hz;
  options.head.camera.field_of_view_deg = 40;
  options.head.camera.width_px = options.head.camera.height_px = 60;
  return run_simulated_head(two_eyed_image(1.0), options);
}

}  // namespace

TEST_CASE("sampling the joints between frames changes nothing else, and follows them at its rate") {
  const Recording plain = one_second(0);
  const Recording sampled = one_second(500);
  CHECK(plain.positions.empty());
  REQUIRE(sampled.frames.size() == plain.frames.size());
  for (std::size_t k = 0; k < plain.frames.size(); ++k) {
    REQUIRE(sampled.frames[k].goal_deg == plain.frames[k].goal_deg);
    REQUIRE(sampled.frames[k].position_deg == plain.frames[k].position_deg);
  }
  CHECK(sampled.spikes == plain.spikes);
  REQUIRE(sampled.positions.size() > 480);
  for (std::size_t i = 0; i < sampled.positions.size(); ++i) {
    REQUIRE(sampled.positions[i].time_ns == 2 * kMs * static_cast<TimeNs>(i));
  }
}
