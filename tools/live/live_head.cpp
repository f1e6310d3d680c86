#include "tools/live/live_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "drivers/camera/device_camera.h"
#include "runtime/loop/real_time.h"

namespace tectum {
namespace {

constexpr std::array<const char*, kEyeCount> kEyeNames = {"left eye", "right eye"};

/// Above the loop's by `above`: what feeds it, and what it feeds, is short and must not wait for it.
std::function<void()> with_priority(int fifo_priority, int above) {
  if (fifo_priority <= 0) {
    return {};
  }
  return [priority = fifo_priority + above] {
    // The loop's own thread asks for the same and says so when it is refused.
    (void)enter_real_time({.fifo_priority = priority, .locks_memory = false, .core = -1});
  };
}

}  // namespace

FrameSourceOpener LiveHead::source_of(const HeadCamera& camera, Eye eye) {
  if (camera.kind == CameraKind::Simulated) {
    return emulated_->eye(eye);
  }
  if (camera.kind == CameraKind::Video) {
    return paced_video(camera.path);
  }
  return camera_device({.path = camera.path,
                        .width_px = camera.width_px,
                        .height_px = camera.height_px,
                        .rate_hz = camera.rate_hz,
                        .exposure = camera.exposure,
                        .pixel_format = camera.pixel_format});
}

std::unique_ptr<LiveHead> LiveHead::open(const HeadFile& file, const SimHeadParams& simulation, int fifo_priority,
                                         std::string& error) {
  std::unique_ptr<LiveHead> head(new LiveHead(file));
  ServoDriverOptions servos;
  servos.kind = file.link;
  servos.map = file.map;
  servos.baud = file.baud;
  servos.in_thread = with_priority(fifo_priority, 1);
  std::string port = file.port;
  if (file.is_emulated) {
    SimHeadParams params = simulation;
    params.geometry = file.geometry;
    head->emulated_ = EmulatedHead::open(params, file.map, file.link, with_priority(fifo_priority, 3), error);
    if (head->emulated_ == nullptr) {
      return nullptr;
    }
    port = head->emulated_->port();
  }
  const std::uint32_t baud = file.baud != 0 ? file.baud : usual_baud(file.link);
  head->servos_ = std::make_unique<ServoDriver>(servos, serial_link(port, baud));
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const HeadCamera& camera = file.cameras[index_of(eye)];
    if (camera.kind != CameraKind::None) {
      LiveCameraOptions options;
      options.name = kEyeNames[index_of(eye)];
      options.width_px = camera.width_px;
      options.height_px = camera.height_px;
      options.crop = camera.crop;
      options.frozen_after_ns = camera.frozen_after_ns;
      options.black_below = camera.black_below;
      options.in_thread = with_priority(fifo_priority, 2);
      head->eyes_[index_of(eye)] = std::make_unique<LiveCamera>(options, head->source_of(camera, eye));
    }
  }
  return head;
}

std::string LiveHead::wait_until_ready(TimeNs timeout_ns) {
  MonotonicClock clock;
  const TimeNs end_ns = clock.now_ns() + timeout_ns;
  if (!servos_->wait_until_ready(timeout_ns)) {
    std::string missing;
    const HeadReport report = servos_->report();
    for (std::size_t j = 0; j < kJointCount; ++j) {
      const bool is_there = report.joints[j].health == ServoHealth::Working && report.joints[j].measured_ns != 0;
      if (file_.map.joints[j].is_present && !is_there) {
        missing += fmt::format("{}{} (ID {})", missing.empty() ? "" : ", ", kHeadJointNames[j], file_.map.joints[j].id);
      }
    }
    return report.is_connected ? fmt::format("no answer from {}", missing)
                               : "the servos' port cannot be opened, or went away";
  }
  const auto has_picture = [&] {
    return std::any_of(eyes_.begin(), eyes_.end(),
                       [](const auto& eye) { return eye != nullptr && eye->newest_at_ns() != 0; });
  };
  const bool has_eye = eyes_[0] != nullptr || eyes_[1] != nullptr;
  while (has_eye && !has_picture()) {
    if (clock.now_ns() >= end_ns) {
      return "no picture from any camera";
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return "";
}

std::vector<LiveEvent> LiveHead::take_events() {
  std::vector<LiveEvent> events;
  for (ServoEvent& event : servos_->take_events()) {
    events.push_back({event.at_ns, std::move(event.text)});
  }
  for (const auto& eye : eyes_) {
    if (eye != nullptr) {
      for (CameraEvent& event : eye->take_events()) {
        events.push_back({event.at_ns, std::move(event.text)});
      }
    }
  }
  std::stable_sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a.at_ns < b.at_ns; });
  return events;
}

}  // namespace tectum
