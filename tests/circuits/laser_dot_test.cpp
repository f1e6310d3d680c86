// The shipped circuit on a real camera recording: what its own retina sees, and where its commands point.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "drivers/camera/video_camera.h"
#include "runtime/loop/control_loop.h"
#include "runtime/loop/echo_servo_bus.h"
#include "runtime/sense/retina.h"
#include "tests/circuits/compiled_circuit.h"
#include "tests/support/laser_dot.h"

using namespace tectum;

namespace {

constexpr int kCameraWidthPx = 320, kCameraHeightPx = 240;
constexpr TimeNs kVideoPeriodNs = 40'000'000;  // 25 frames a second
constexpr int kTrialFrames = 8;                // 0.32 s, the longest latency of a saccade

/// One picture, shown again and again: a still scene.
class StillCamera final : public Camera {
 public:
  explicit StillCamera(const Frame& frame) : frame_(frame) {}
  [[nodiscard]] CameraStatus read(TimeNs now_ns, Frame& out) noexcept override {
    out = frame_;
    out.captured_ns = now_ns;
    out.sequence = sequence_++;
    return CameraStatus::NewFrame;
  }

 private:
  Frame frame_;
  std::uint64_t sequence_ = 0;
};

class TrialClock final : public Clock {
 public:
  [[nodiscard]] TimeNs now_ns() noexcept override { return now_ns_; }
  void sleep_until(TimeNs when_ns) noexcept override { now_ns_ = when_ns; }

 private:
  TimeNs now_ns_ = 0;
};

CameraToReference map_of(const RetinaRecord& retina) {
  // The largest centred square of the picture.
  return {.reference_per_camera_px = static_cast<float>(retina.frame_height) / kCameraHeightPx,
          .crop_left_px = (kCameraWidthPx - kCameraHeightPx) / 2.0F,
          .crop_top_px = 0};
}

struct Direction {
  double pan = 0, tilt = 0;
};

/// Where the dot is from the optical axis, in degrees.
Direction dot_direction(const DotTruth& truth, const RetinaRecord& retina) {
  const CameraToReference map = map_of(retina);
  const double x =
      (truth.x_px + 0.5 - static_cast<double>(map.crop_left_px)) * static_cast<double>(map.reference_per_camera_px) -
      retina.frame_width / 2.0;
  const double y = retina.frame_height / 2.0 - (truth.y_px + 0.5) * static_cast<double>(map.reference_per_camera_px);
  const double radians = std::numbers::pi / 180;
  const double focal_px = retina.frame_width / 2.0 / std::tan(retina.field_of_view_deg * radians / 2);
  return {.pan = std::atan2(x, focal_px) / radians, .tilt = std::atan2(y, focal_px) / radians};
}

/// How far the circuit, at rest until then, tells each eye to go when it sees this picture for a third of a second,
/// less what it tells them to do in the dark.
std::array<Direction, kEyeCount> commanded(const SpikeImage& image, const Frame& picture,
                                           const std::array<double, kJointCount>& in_the_dark_deg) {
  StillCamera left(picture), right(picture);
  EchoServoBus servos;
  TrialClock clock;
  LoopOptions options;
  options.frame_period_ns = kVideoPeriodNs;
  ControlLoop loop(image, {.left = &left, .right = &right, .servos = servos, .clock = clock}, options);
  for (int turn = 0; turn < kTrialFrames; ++turn) {
    REQUIRE(loop.turn() == LoopStatus::Running);
  }
  const auto& goal = loop.frame().decoded_deg;
  const auto moved = [&](Joint joint) {
    return goal[static_cast<std::size_t>(joint)] - in_the_dark_deg[static_cast<std::size_t>(joint)];
  };
  return {Direction{moved(Joint::LeftEyePan), moved(Joint::LeftEyeTilt)},
          Direction{moved(Joint::RightEyePan), moved(Joint::RightEyeTilt)}};
}

std::array<double, kJointCount> commanded_in_the_dark(const SpikeImage& image) {
  const std::vector<std::uint8_t> black(3 * kCameraWidthPx * kCameraHeightPx);
  StillCamera eye({.bgr = black.data(),
                   .width_px = kCameraWidthPx,
                   .height_px = kCameraHeightPx,
                   .stride_bytes = 3 * kCameraWidthPx});
  EchoServoBus servos;
  TrialClock clock;
  LoopOptions options;
  options.frame_period_ns = kVideoPeriodNs;
  ControlLoop loop(image, {.left = &eye, .right = &eye, .servos = servos, .clock = clock}, options);
  for (int turn = 0; turn < kTrialFrames; ++turn) {
    REQUIRE(loop.turn() == LoopStatus::Running);
  }
  return loop.frame().decoded_deg;
}

struct Pointing {
  int outside_fovea = 0, left = 0, right = 0, both = 0;
};

constexpr double kFoveaDeg = 1;  // radius; on the fovea there is nowhere to point

}  // namespace

TEST_CASE("on a real recording the circuit sees the dot alone, and both eyes' commands point towards it") {
  const std::string folder = laser_dot_folder();
  if (folder.empty()) {
    MESSAGE("skipped: the recording is not there");
    return;
  }
  const SpikeImage image = compiled_circuit(oculomotor_text());
  const RetinaRecord& record = image.retinas[0];
  const auto fields = image.fields.subspan(record.first_field, record.field_count);
  Retina retina(image, 0);
  REQUIRE(retina.prepare(kCameraWidthPx, kCameraHeightPx));
  std::string error;
  const auto video = VideoSource::open(folder + "laser_dot.avi", error);
  REQUIRE_MESSAGE(video != nullptr, error);
  const auto dark = commanded_in_the_dark(image);

  DotScore without_boxes, all;
  Pointing pointing;
  const std::vector<DotTruth> truths = read_dot_truth(folder + "laser_dot_truth.csv");
  for (std::size_t k = 0; k < truths.size(); ++k) {
    Frame frame;
    REQUIRE(video->view(Eye::Left).read(video->due_ns(k), frame) == CameraStatus::NewFrame);
    REQUIRE(retina.encode(frame));
    all.add(truths[k], retina.active(), fields, map_of(record));
    if (truths[k].has_drawn_box) {
      continue;
    }
    without_boxes.add(truths[k], retina.active(), fields, map_of(record));
    const Direction dot = dot_direction(truths[k], record);
    if (!truths[k].is_visible || std::hypot(dot.pan, dot.tilt) <= kFoveaDeg) {
      continue;
    }
    const auto told = commanded(image, frame, dark);
    const auto is_towards = [&dot](const Direction& d) { return d.pan * dot.pan + d.tilt * dot.tilt > 0; };
    ++pointing.outside_fovea;
    pointing.left += is_towards(told[0]) ? 1 : 0;
    pointing.right += is_towards(told[1]) ? 1 : 0;
    pointing.both += is_towards(told[0]) && is_towards(told[1]) ? 1 : 0;
  }
  MESSAGE("without the drawn boxes: ", without_boxes.text());
  MESSAGE("all frames: ", all.text());
  MESSAGE("commands point towards the dot in ", pointing.both, " of ", pointing.outside_fovea,
          " frames with the dot outside the fovea (left ", pointing.left, ", right ", pointing.right, ")");
  CHECK(without_boxes.visible == 253);
  CHECK(without_boxes.off == 95);
  CHECK(without_boxes.both >= 0.95 * without_boxes.visible);
  CHECK(without_boxes.silent == without_boxes.off);
  CHECK(pointing.outside_fovea > 200);
  CHECK(pointing.both >= 0.95 * pointing.outside_fovea);
}
