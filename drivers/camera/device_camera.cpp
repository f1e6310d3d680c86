#include "drivers/camera/device_camera.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "drivers/camera/video_camera.h"
#include "drivers/camera/video_library.h"

namespace tectum {
namespace {

TimeNs monotonic_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

class PacedVideo final : public FrameSource {
 public:
  explicit PacedVideo(std::unique_ptr<VideoSource> video) : video_(std::move(video)), start_ns_(monotonic_ns()) {}

  [[nodiscard]] CameraStatus wait(Frame& out) override {
    const auto at_most_ns = static_cast<TimeNs>(100'000'000);
    const TimeNs due_in_ns = start_ns_ + video_->due_ns(next_) - monotonic_ns();
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::clamp<TimeNs>(due_in_ns, 0, at_most_ns)));
    const CameraStatus status = video_->view(Eye::Left).read(monotonic_ns() - start_ns_, out);
    if (status == CameraStatus::NewFrame) {
      next_ = out.sequence + 1;
      out.captured_ns += start_ns_;
    }
    return status;
  }

 private:
  std::unique_ptr<VideoSource> video_;
  TimeNs start_ns_;
  std::uint64_t next_ = 0;
};

}  // namespace

FrameSourceOpener paced_video(const std::string& path) {
  return [path](std::string& error) -> std::unique_ptr<FrameSource> {
    std::unique_ptr<VideoSource> video = VideoSource::open(path, error);
    return video == nullptr ? nullptr : std::make_unique<PacedVideo>(std::move(video));
  };
}

FrameSourceOpener camera_device(const CameraDeviceParams& params) {
  return [params](std::string& error) { return open_camera_device(params, error); };
}

}  // namespace tectum
