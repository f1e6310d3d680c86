#include "drivers/camera/video_library.h"

#include <dlfcn.h>

#include "drivers/camera/side_library.h"

namespace tectum {
namespace {

constexpr const char* kLibraryName = "libtectum_video.so";

/// Never closed: frames and writers live in it.
void* video_library(std::string& error) {
  static void* const library = open_side_library(kLibraryName);
  if (library == nullptr) {
    const char* why = dlerror();
    error = std::string("libtectum_video.so, which reads and writes video, cannot be loaded") +
            (why != nullptr ? std::string(": ") + why : "");
  }
  return library;
}

template <typename Function>
Function* find_function(const char* name, std::string& error) {
  void* const library = video_library(error);
  if (library == nullptr) {
    return nullptr;
  }
  auto* const function = reinterpret_cast<Function*>(dlsym(library, name));
  if (function == nullptr) {
    error = std::string("libtectum_video.so is of another version: it has no ") + name;
  }
  return function;
}

}  // namespace

std::unique_ptr<VideoSource> VideoSource::open(const std::string& path, std::string& error, double fps_override) {
  auto* const function = find_function<decltype(tectum_open_video_source)>("tectum_open_video_source", error);
  return std::unique_ptr<VideoSource>(function != nullptr ? function(path, error, fps_override) : nullptr);
}

std::unique_ptr<EyeVideoWriter> EyeVideoWriter::open(const VideoWriterParams& params, std::string& error) {
  auto* const function = find_function<decltype(tectum_open_video_writer)>("tectum_open_video_writer", error);
  return std::unique_ptr<EyeVideoWriter>(function != nullptr ? function(params, error) : nullptr);
}

std::unique_ptr<FrameSource> open_camera_device(const CameraDeviceParams& params, std::string& error) {
  auto* const function = find_function<decltype(tectum_open_camera_device)>("tectum_open_camera_device", error);
  return std::unique_ptr<FrameSource>(function != nullptr ? function(params, error) : nullptr);
}

}  // namespace tectum
