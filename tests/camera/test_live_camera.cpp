// A camera's faults on a scripted source: what is passed on, and what people are told.
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "drivers/camera/live_camera.h"

using namespace tectum;
using namespace std::chrono_literals;

namespace {

constexpr TimeNs kMs = 1'000'000;

/// What the source does, changed by the test while the camera runs.
struct Script {
  std::atomic<int> brightness = 100;  // of every sample; -1: counts up, so that no two frames are the same
  std::atomic<int> width_px = 32;
  std::atomic<bool> is_there = true;
  std::atomic<bool> is_silent = false;
  std::atomic<bool> has_ended = false;
  std::atomic<int> sent = 0;
};

class ScriptedSource final : public FrameSource {
 public:
  explicit ScriptedSource(Script& script) : script_(script) {}
  CameraStatus wait(Frame& out) override {
    std::this_thread::sleep_for(2ms);
    if (!script_.is_there) {
      return CameraStatus::Failed;
    }
    if (script_.has_ended) {
      return CameraStatus::Ended;
    }
    if (script_.is_silent) {
      return CameraStatus::NoNewFrame;
    }
    const int width = script_.width_px;
    const int given = script_.brightness;
    ++script_.sent;
    pixels_.assign(static_cast<std::size_t>(3 * width * 16),
                   static_cast<std::uint8_t>(given >= 0 ? given : 50 + script_.sent % 100));
    out = {pixels_.data(), width, 16, static_cast<std::size_t>(3 * width), 1000 + script_.sent, 0};
    return CameraStatus::NewFrame;
  }

 private:
  Script& script_;
  std::vector<std::uint8_t> pixels_;
};

struct Eye {
  explicit Eye(LiveCameraOptions options = {}, bool is_there = true) {
    script.is_there = is_there;
    options.name = "left eye";
    options.reopen_every_ns = 20 * kMs;
    camera = std::make_unique<LiveCamera>(options, [this](std::string& error) -> std::unique_ptr<FrameSource> {
      if (!script.is_there) {
        error = "no such device";
        return nullptr;
      }
      return std::make_unique<ScriptedSource>(script);
    });
  }
  /// True as soon as a line with this text was told; false after ten seconds.
  bool told(const std::string& what) {
    for (int wait = 0; wait < 5000; ++wait) {
      for (const CameraEvent& event : camera->take_events()) {
        if (event.text.find(what) != std::string::npos) {
          return true;
        }
      }
      std::this_thread::sleep_for(2ms);
    }
    return false;
  }
  bool sees() {
    Frame frame;
    for (int wait = 0; wait < 5000; ++wait) {
      if (camera->read(0, frame) == CameraStatus::NewFrame) {
        return true;
      }
      std::this_thread::sleep_for(2ms);
    }
    return false;
  }
  /// Nothing new in the time of some thirty frames, the one under way apart.
  bool is_blind() {
    Frame frame;
    (void)camera->read(0, frame);
    std::this_thread::sleep_for(20ms);
    (void)camera->read(0, frame);
    std::this_thread::sleep_for(60ms);
    return camera->read(0, frame) != CameraStatus::NewFrame;
  }
  Script script;
  std::unique_ptr<LiveCamera> camera;
};

}  // namespace

TEST_CASE("the newest frame is taken once, with its pixels and its time of capture") {
  Eye eye;
  REQUIRE(eye.sees());
  std::this_thread::sleep_for(30ms);
  Frame frame;
  REQUIRE(eye.camera->read(0, frame) == CameraStatus::NewFrame);
  CHECK(frame.width_px == 32);
  CHECK(frame.bgr[0] == 100);
  CHECK(frame.captured_ns > 1001);
  CHECK(eye.camera->counters().overwritten > 0);
  eye.script.is_silent = true;
  std::this_thread::sleep_for(20ms);
  (void)eye.camera->read(0, frame);
  CHECK(eye.camera->read(0, frame) == CameraStatus::NoNewFrame);
}

TEST_CASE("only the crop is passed on") {
  LiveCameraOptions options;
  options.crop = {4, 2, 8, 10};
  Eye eye(options);
  Frame frame;
  REQUIRE(eye.sees());
  std::this_thread::sleep_for(20ms);
  REQUIRE(eye.camera->read(0, frame) == CameraStatus::NewFrame);
  CHECK(frame.width_px == 8);
  CHECK(frame.height_px == 10);
  CHECK(frame.stride_bytes == 24);
}

TEST_CASE("an unplugged camera is told, and seen again when it is back") {
  Eye eye;
  REQUIRE(eye.sees());
  eye.script.is_there = false;
  CHECK(eye.told("left eye: gone; is it unplugged?"));
  CHECK(eye.is_blind());
  Frame frame;
  CHECK(eye.camera->read(0, frame) == CameraStatus::Failed);
  eye.script.is_there = true;
  CHECK(eye.told("left eye: sees again"));
  CHECK(eye.sees());
  CHECK(eye.camera->counters().reopened == 1);
}

TEST_CASE("a camera that falls silent is told") {
  LiveCameraOptions options;
  options.silent_after_ns = 30 * kMs;
  Eye eye(options);
  REQUIRE(eye.sees());
  eye.script.is_silent = true;
  CHECK(eye.told("left eye: no frame for 0.0 s"));
  eye.script.is_silent = false;
  CHECK(eye.told("sees again"));
}

TEST_CASE("a frozen picture is passed on for a while and no longer") {
  LiveCameraOptions options;
  options.frozen_after_ns = 100 * kMs;
  Eye eye(options);
  eye.script.brightness = -1;
  REQUIRE(eye.sees());
  eye.script.brightness = 77;
  CHECK(eye.told("left eye: the same picture for 0.1 s; is it frozen?"));
  CHECK(eye.is_blind());
  eye.script.brightness = -1;
  CHECK(eye.told("sees again"));
  CHECK(eye.sees());
  CHECK(eye.camera->counters().frozen > 0);
}

TEST_CASE("a black picture is not passed on") {
  LiveCameraOptions options;
  options.black_below = 4;
  Eye eye(options);
  REQUIRE(eye.sees());
  eye.script.brightness = 3;
  CHECK(eye.told("left eye: black picture; is the lens covered?"));
  CHECK(eye.is_blind());
  eye.script.brightness = 4;
  CHECK(eye.told("sees again"));
}

TEST_CASE("a picture of another size is not passed on, and both sizes are told") {
  Eye eye;
  REQUIRE(eye.sees());
  eye.script.width_px = 48;
  CHECK(eye.told("left eye: sends 48 x 16 pixels, not 32 x 16"));
  CHECK(eye.is_blind());
}

TEST_CASE("a camera that is not there at the start is waited for") {
  Eye eye({}, false);
  CHECK(eye.told("left eye: no such device"));
  eye.script.is_there = true;
  CHECK(eye.told("sees again"));
}

TEST_CASE("a recording's end is passed on") {
  Eye eye;
  REQUIRE(eye.sees());
  eye.script.has_ended = true;
  Frame frame;
  CameraStatus status = CameraStatus::NewFrame;
  for (int wait = 0; wait < 5000 && status != CameraStatus::Ended; ++wait) {
    status = eye.camera->read(0, frame);
    std::this_thread::sleep_for(2ms);
  }
  CHECK(status == CameraStatus::Ended);
}
