#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "drivers/camera/device_camera.h"
#include "drivers/camera/video_library.h"

namespace tectum {
namespace {

constexpr double kManualExposure = 1;  // V4L2_EXPOSURE_MANUAL; 3 is the automatic of most webcams

TimeNs monotonic_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

class CameraDevice final : public FrameSource {
 public:
  [[nodiscard]] bool open(const CameraDeviceParams& params, std::string& error) {
    std::error_code failure;
    if (!std::filesystem::exists(params.path, failure)) {
      error = params.path + ": no such device; is the camera plugged in?";
      return false;
    }
    setenv("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", "1", 0);  // seconds to wait for a frame; OpenCV's own is 10
    if (!capture_.open(params.path, cv::CAP_V4L2)) {
      error = params.path + ": is no camera, or another program has it";
      return false;
    }
    if (params.pixel_format.size() == 4) {
      const std::string& f = params.pixel_format;
      capture_.set(cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc(f[0], f[1], f[2], f[3]));
    }
    set(cv::CAP_PROP_FRAME_WIDTH, params.width_px);
    set(cv::CAP_PROP_FRAME_HEIGHT, params.height_px);
    set(cv::CAP_PROP_FPS, params.rate_hz);
    capture_.set(cv::CAP_PROP_BUFFERSIZE, 1);
    if (params.exposure > 0) {
      capture_.set(cv::CAP_PROP_AUTO_EXPOSURE, kManualExposure);
      capture_.set(cv::CAP_PROP_EXPOSURE, params.exposure);
      capture_.set(cv::CAP_PROP_AUTOFOCUS, 0);
    }
    return true;
  }

  [[nodiscard]] CameraStatus wait(Frame& out) override {
    try {
      if (!capture_.read(picture_) || picture_.type() != CV_8UC3) {
        return CameraStatus::Failed;
      }
    } catch (const cv::Exception&) {
      return CameraStatus::Failed;
    }
    // The driver's stamp, on the monotonic clock; not all drivers give one.
    const TimeNs now_ns = monotonic_ns();
    const auto stamp_ns = static_cast<TimeNs>(std::llround(capture_.get(cv::CAP_PROP_POS_MSEC) * 1e6));
    const bool is_believable = stamp_ns > now_ns - 1'000'000'000 && stamp_ns <= now_ns;
    out = {picture_.data, picture_.cols, picture_.rows, picture_.step, is_believable ? stamp_ns : now_ns, sequence_++};
    return CameraStatus::NewFrame;
  }

 private:
  void set(int property, double value) {
    if (value > 0) {
      capture_.set(property, value);
    }
  }
  cv::VideoCapture capture_;
  cv::Mat picture_;
  std::uint64_t sequence_ = 0;
};

}  // namespace

extern "C" FrameSource* tectum_open_camera_device(const CameraDeviceParams& params, std::string& error) {
  try {
    auto device = std::make_unique<CameraDevice>();
    return device->open(params, error) ? device.release() : nullptr;
  } catch (const cv::Exception& failure) {
    error = params.path + ": " + failure.what();
    return nullptr;
  }
}

}  // namespace tectum
