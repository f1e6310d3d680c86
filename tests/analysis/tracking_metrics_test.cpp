#include "tools/analysis/tracking_metrics.h"

#include <doctest/doctest.h>
#include <cmath>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr TimeNs kFrameNs = 20'000'000;

/// A run of `count` frames at 50 Hz, wall 1 m away, in which every error is 0 and the target rests.
Recording resting_run(std::size_t count) {
  Recording recording;
  recording.tick_ns = 100'000;
  recording.frame_period_ns = kFrameNs;
  recording.wall_distance_m = 1;
  for (std::size_t k = 0; k < count; ++k) {
    RecordedFrame frame;
    frame.tick = k * 200;
    frame.time_ns = static_cast<TimeNs>(k) * kFrameNs;
    frame.has_truth = true;
    recording.frames.push_back(frame);
  }
  return recording;
}

TEST_CASE("the error measures equal values worked out by hand") {
  const ErrorStats stats = error_stats({-3, 0.5, 1, -0.5, 4});
  CHECK(stats.frames == 5);
  CHECK(stats.median_deg == doctest::Approx(0.5));
  CHECK(stats.median_abs_deg == doctest::Approx(1.0));
  CHECK(stats.rmse_deg == doctest::Approx(std::sqrt((9 + 0.25 + 1 + 0.25 + 16) / 5)));
  CHECK(stats.p90_abs_deg == doctest::Approx(3.6));  // rank 3.6 of 0.5 0.5 1 3 4
  CHECK(stats.fovea_share == doctest::Approx(0.4));  // 1 deg itself is off the fovea
}

TEST_CASE("no samples give zeros and not a number that is none") {
  const ErrorStats stats = error_stats({});
  CHECK(stats.frames == 0);
  CHECK(stats.rmse_deg == 0);
  CHECK(median({}) == 0);
}

TEST_CASE("quantiles interpolate between order statistics") {
  CHECK(quantile(std::vector<double>{4, 1, 3, 2}, 0.5) == doctest::Approx(2.5));
  CHECK(quantile(std::vector<double>{4, 1, 3, 2}, 0.0) == doctest::Approx(1));
  CHECK(quantile(std::vector<double>{4, 1, 3, 2}, 1.0) == doctest::Approx(4));
  CHECK(quantile(std::vector<double>{7}, 0.9) == doctest::Approx(7));
}

TEST_CASE("settled measures leave out the 300 ms from each jump of the target") {
  Recording recording = resting_run(60);
  for (std::size_t k = 20; k < 60; ++k) {
    recording.frames[k].target_on_wall_m = {0.1, 0};
    // 10 deg of error for exactly 300 ms (frames 20 to 34), then 0.5 deg.
    recording.frames[k].eye[0].error_pan_deg = k < 35 ? 10 : 0.5;
  }
  const TrackingMetrics metrics = tracking_metrics(recording);
  REQUIRE(metrics.target_jumps_s.size() == 1);
  CHECK(metrics.target_jumps_s[0] == doctest::Approx(0.4));
  CHECK(metrics.eye[0].pan.all.frames == 60);
  CHECK(metrics.eye[0].pan.settled.frames == 45);
  CHECK(metrics.eye[0].pan.settled.p90_abs_deg == doctest::Approx(0.5));
  CHECK(metrics.eye[0].pan.all.rmse_deg == doctest::Approx(std::sqrt((15 * 100 + 25 * 0.25) / 60)));
  CHECK(metrics.eye[1].pan.all.rmse_deg == 0);
}

TEST_CASE("smooth motion of the target is no jump, however fast") {
  Recording recording = resting_run(200);
  for (std::size_t k = 0; k < 200; ++k) {
    recording.frames[k].target_on_wall_m = {0.4 * std::sin(0.1 * static_cast<double>(k)), 0};
  }
  CHECK(target_jump_times_s(recording).empty());
}

TEST_CASE("jitter is the median peak-to-peak gaze of the settled part of a hold") {
  Recording recording = resting_run(120);
  for (std::size_t k = 0; k < 120; ++k) {
    const std::size_t hold = k / 40;  // jumps at frames 40 and 80
    recording.frames[k].target_on_wall_m = {0.1 * static_cast<double>(hold), 0};
    recording.frames[k].eye[0].gaze_pan_deg = (k % 2 == 0 ? 0.1 : -0.1) * static_cast<double>(hold);
  }
  // Holds after a jump: 0.2 and 0.4 deg peak to peak; their median is 0.3.
  CHECK(tracking_metrics(recording).eye[0].pan.jitter_deg == doctest::Approx(0.3));
}

TEST_CASE("the combined angle follows from pan and tilt on the sphere") {
  Recording recording = resting_run(3);
  for (RecordedFrame& frame : recording.frames) {
    frame.eye[1].error_pan_deg = 60;
    frame.eye[1].error_tilt_deg = 60;
  }
  const double expected_deg = std::acos(0.25) * 180 / 3.14159265358979323846;
  CHECK(tracking_metrics(recording).eye[1].angle.rmse_deg == doctest::Approx(expected_deg));
}

TEST_CASE("the wall-referenced error is gaze minus target as seen from straight ahead") {
  Recording recording = resting_run(3);
  for (RecordedFrame& frame : recording.frames) {
    frame.target_on_wall_m = {1, 0};        // 45 deg
    frame.eye[0].gaze_on_wall_m = {0, -1};  // 0 and -45 deg
  }
  const TrackingMetrics metrics = tracking_metrics(recording);
  CHECK(metrics.eye[0].pan.wall.median_deg == doctest::Approx(-45));
  CHECK(metrics.eye[0].tilt.wall.median_deg == doctest::Approx(-45));
}

TEST_CASE("neck travel sums what the neck moved, there and back") {
  Recording recording = resting_run(5);
  const double pan_deg[] = {0, 2, 2, -1, 0};
  for (std::size_t k = 0; k < 5; ++k) {
    recording.frames[k].position_deg[static_cast<std::size_t>(Joint::NeckPan)] = pan_deg[k];
  }
  CHECK(tracking_metrics(recording).neck_pan_travel_deg == doctest::Approx(6));
}

TEST_CASE("a run without truth has no error but a neck") {
  Recording recording = resting_run(2);
  recording.frames[0].has_truth = recording.frames[1].has_truth = false;
  recording.frames[1].position_deg[static_cast<std::size_t>(Joint::NeckTilt)] = 3;
  const TrackingMetrics metrics = tracking_metrics(recording);
  CHECK_FALSE(metrics.has_truth);
  CHECK(metrics.eye[0].pan.all.frames == 0);
  CHECK(metrics.neck_tilt_travel_deg == doctest::Approx(3));
}

TEST_CASE("an empty recording and one of a single frame are measured without harm") {
  CHECK_FALSE(tracking_metrics(Recording{}).has_truth);
  CHECK(tracking_metrics(resting_run(1)).eye[0].pan.all.frames == 1);
}

TEST_CASE("the direction seen is that of the active fields' centres through a pinhole") {
  Recording recording = resting_run(2);
  RecordedRetina retina;
  retina.eye = Eye::Right;
  retina.field_of_view_deg = 90;  // focal length = half the width
  retina.frame_width = 200;
  retina.frame_height = 100;
  retina.fields = {{190, 40, 210, 60}, {100, 0, 100, 0}, {90, -60, 110, -40}};
  recording.retinas.push_back(retina);
  recording.frames[0].active_fields[1] = {0};
  recording.frames[1].active_fields[1] = {2, 99};  // an index outside the retina is passed over
  const AngleTrace seen = seen_direction_trace(recording, Eye::Right);
  REQUIRE(seen.time_s.size() == 2);
  CHECK(seen.pan_deg[0] == doctest::Approx(45));
  CHECK(seen.tilt_deg[0] == doctest::Approx(0));
  CHECK(seen.pan_deg[1] == doctest::Approx(0));
  CHECK(seen.tilt_deg[1] == doctest::Approx(45));
  CHECK(seen_direction_trace(recording, Eye::Left).time_s.empty());
}

}  // namespace
}  // namespace tectum
