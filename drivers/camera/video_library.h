// The functions of the video library, libtectum_video.so beside the binary.
//
// OpenCV's video input and output pull in more than two hundred shared libraries, which cost every start of the binary
// 0.2 to 0.5 s. So they are linked into a library of their own, which VideoSource::open and EyeVideoWriter::open load
// when the first video is asked for.
#pragma once

#include <memory>
#include <string>

#include "drivers/camera/device_camera.h"
#include "drivers/camera/video_camera.h"
#include "drivers/camera/video_writer.h"

namespace tectum {

extern "C" {
/// Null with a line in `error` when the file cannot be read. The caller owns the source.
VideoSource* tectum_open_video_source(const std::string& path, std::string& error, double fps_override);
/// Null with a line in `error` when the file cannot be written. The caller owns the writer.
EyeVideoWriter* tectum_open_video_writer(const VideoWriterParams& params, std::string& error);
/// Null with a line in `error` when there is no such camera. The caller owns the source.
FrameSource* tectum_open_camera_device(const CameraDeviceParams& params, std::string& error);
}

/// The last of them, through the library.
[[nodiscard]] std::unique_ptr<FrameSource> open_camera_device(const CameraDeviceParams& params, std::string& error);

}  // namespace tectum
