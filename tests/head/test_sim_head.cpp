#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "drivers/head/sim_head.h"

using namespace tectum;

namespace {

// Turns the head to and fro for a while and returns every byte that both eyes delivered.
std::vector<std::uint8_t> film(const SimHeadParams& params, int turns) {
  SimHead head(params);
  std::vector<std::uint8_t> bytes;
  for (int turn = 0; turn < turns; ++turn) {
    const TimeNs now_ns = turn * params.frame_period_ns;
    head.sleep_until(now_ns);
    for (const Eye eye : {Eye::Left, Eye::Right}) {
      Frame frame;
      if (head.eye_camera(eye).read(now_ns, frame) == CameraStatus::NewFrame) {
        for (int y = 0; y < frame.height_px; ++y) {
          const std::uint8_t* row = frame.bgr + static_cast<std::size_t>(y) * frame.stride_bytes;
          bytes.insert(bytes.end(), row, row + 3 * frame.width_px);
        }
      }
    }
    ServoCommand command;
    command.goal_deg = {turn * 0.1, 3, -turn * 0.1, 3, turn * 0.05, -2};
    REQUIRE(head.write(command));
  }
  return bytes;
}

SimHeadParams small_cameras() {
  SimHeadParams params;
  params.camera.width_px = params.camera.height_px = 96;
  params.camera.noise_sigma = 3;
  return params;
}

}  // namespace

TEST_CASE("the same seed gives the same film byte for byte, another seed another one") {
  for (const bool clutter : {false, true}) {
    SimHeadParams params = small_cameras();
    params.camera.clutter = clutter;
    const auto first = film(params, 90);  // 2 s
    CHECK(first.size() == 89U * 2U * 96U * 96U * 3U);
    CHECK(first == film(params, 90));
    params.seed = 2;
    CHECK(first != film(params, 90));
  }
}

TEST_CASE("without noise another seed still differs: other targets, other dead times") {
  SimHeadParams params = small_cameras();
  params.camera.noise_sigma = 0;
  const auto first = film(params, 90);
  params.seed = 2;
  CHECK(first != film(params, 90));
}

TEST_CASE("a frame comes out the stated number of frames after its exposure, and each only once") {
  for (const std::uint32_t latency : {0U, 1U, 3U}) {
    CAPTURE(latency);
    SimHeadParams params = small_cameras();
    params.camera_latency_frames = latency;
    SimHead head(params);
    Camera& camera = head.eye_camera(Eye::Right);
    Frame frame;
    for (std::uint32_t turn = 0; turn < 10; ++turn) {
      const TimeNs now_ns = turn * params.frame_period_ns;
      head.sleep_until(now_ns);
      const CameraStatus status = camera.read(now_ns, frame);
      CHECK((status == CameraStatus::NewFrame) == (turn >= latency));
      if (turn >= latency) {
        CHECK(frame.sequence == turn - latency);
        CHECK(frame.captured_ns == (turn - latency) * params.frame_period_ns);
      }
      CHECK(camera.read(now_ns, frame) == CameraStatus::NoNewFrame);
    }
  }
}

TEST_CASE("a reader that is late gets the newest frame and skips the others") {
  const SimHeadParams params = small_cameras();
  SimHead head(params);
  Frame frame;
  head.sleep_until(100 * params.frame_period_ns + 5);
  CHECK(head.eye_camera(Eye::Left).read(head.now_ns(), frame) == CameraStatus::NewFrame);
  CHECK(frame.sequence == 99);
}

TEST_CASE("the picture shows the moment of the exposure, not that of the reading") {
  SimHeadParams params = small_cameras();
  params.camera.noise_sigma = 0;
  params.camera_latency_frames = 3;
  params.scenario.kind = ScenarioKind::Hold;
  params.scenario.hold_at_m = {0, 0};
  SimHead head(params);
  ServoCommand command;
  command.goal_deg = {20, 0, 20, 0, 0, 0};
  REQUIRE(head.write(command));
  EyeCamera camera(params.camera, params.geometry, 0);
  std::vector<HeadTruth> truths;
  for (int turn = 0; turn < 12; ++turn) {
    head.sleep_until(turn * params.frame_period_ns);
    truths.push_back(head.truth_at_now());
    Frame frame;
    if (head.eye_camera(Eye::Left).read(head.now_ns(), frame) == CameraStatus::NewFrame) {
      const HeadTruth& then = truths[static_cast<std::size_t>(turn) - 3];
      const cv::Mat& expected = camera.render(eye_pose(params.geometry, then.joint_deg, Eye::Left), {0, 0}, 0);
      for (int y = 0; y < frame.height_px; ++y) {
        REQUIRE(std::memcmp(frame.bgr + static_cast<std::size_t>(y) * frame.stride_bytes, expected.ptr(y), 3U * 96U) ==
                0);
      }
    }
  }
  CHECK(truths.back().eye[0].gaze_pan_deg > 15);
}

TEST_CASE("the truth agrees with the kinematics and with what the servos report") {
  SimHeadParams params = small_cameras();
  params.scenario.kind = ScenarioKind::Hold;
  params.scenario.hold_at_m = {0.1, 0.05};
  SimHead head(params);
  ServoCommand command;
  const Direction left = eye_angles_towards(params.geometry, 10, 2, Eye::Left, {0.1, 0.05});
  const Direction right = eye_angles_towards(params.geometry, 10, 2, Eye::Right, {0.1, 0.05});
  command.goal_deg = {left.pan_deg, left.tilt_deg, right.pan_deg, right.tilt_deg, 10, 2};
  REQUIRE(head.write(command));
  head.sleep_until(2'000'000'000);
  const HeadTruth truth = head.truth_at_now();
  ServoFeedback feedback;
  head.read(head.now_ns(), feedback);
  CHECK(feedback.fresh_mask == 0x3F);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    CHECK(std::abs(feedback.position_deg[j] - truth.joint_deg[j]) <= 0.15);
    CHECK(std::abs(truth.joint_deg[j] - command.goal_deg[j]) <= 0.45);
  }
  for (const EyeGaze& eye : truth.eye) {
    CHECK(std::abs(eye.error_pan_deg) < 1);
    CHECK(std::abs(eye.error_tilt_deg) < 1);
    CHECK(std::abs(eye.gaze_on_wall_m[0] - 0.1) < 0.01);
    CHECK(std::abs(eye.gaze_on_wall_m[1] - 0.05) < 0.01);
    CHECK(eye.target_pan_deg - eye.gaze_pan_deg == doctest::Approx(eye.error_pan_deg).epsilon(0.1));
  }
}

TEST_CASE("time never runs backwards and the head starts where it is told") {
  SimHeadParams params = small_cameras();
  params.start_deg = {6, 1, -6, 1, 0, 0};
  SimHead head(params);
  CHECK(head.truth_at_now().eye[0].gaze_pan_deg == doctest::Approx(6));
  head.sleep_until(500);
  head.sleep_until(100);
  CHECK(head.now_ns() == 500);
}

TEST_CASE("dropped frames are lost to both eyes, as often as is said and the same ones for the same seed") {
  SimHeadParams params;
  params.camera.width_px = params.camera.height_px = 32;
  const auto seen = [&](double share, std::uint64_t seed) {
    params.dropped_share = share;
    params.seed = seed;
    SimHead head(params);
    std::vector<std::uint64_t> sequences;
    for (TimeNs turn = 1; turn <= 1000; ++turn) {
      head.sleep_until(turn * params.frame_period_ns);
      HeadExposure left, right;
      const CameraStatus status = head.take_exposure(Eye::Left, head.now_ns(), left);
      CHECK(head.take_exposure(Eye::Right, head.now_ns(), right) == status);
      if (status == CameraStatus::NewFrame) {
        CHECK(left.sequence == static_cast<std::uint64_t>(turn - 1));  // never an older one in its place
        sequences.push_back(left.sequence);
      }
    }
    return sequences;
  };
  CHECK(seen(0, 1).size() == 1000);
  const std::vector<std::uint64_t> some = seen(0.3, 1);
  CHECK(some.size() > 650);  // 700 with a standard deviation of 14.5
  CHECK(some.size() < 750);
  CHECK(seen(0.3, 1) == some);
  CHECK(seen(0.3, 2) != some);
}
