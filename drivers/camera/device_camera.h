// A camera that is plugged in, and a video file played at its own pace, as sources for a LiveCamera.
#pragma once

#include <string>

#include "drivers/camera/live_camera.h"

namespace tectum {

/// 0 or empty: as the device is set up.
struct CameraDeviceParams {
  std::string path;  // "/dev/video0"
  int width_px = 0, height_px = 0;
  double rate_hz = 0;
  double exposure = 0;       // manual, in V4L2's 0.1 ms
  std::string pixel_format;  // four letters: "MJPG", "YUYV"
};

/// Through OpenCV's V4L2 reader, with one buffer so that no old frame waits; times of capture are the driver's own.
[[nodiscard]] FrameSourceOpener camera_device(const CameraDeviceParams& params);
[[nodiscard]] FrameSourceOpener paced_video(const std::string& path);

}  // namespace tectum
