// Recorded video as one or two eyes, through OpenCV's VideoCapture.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "runtime/image/spike_image.h"
#include "runtime/ports/camera.h"

namespace tectum {

/// One recording. Frame k counts as captured at k / fps; a reader gets the newest frame that is due, so a slow loop
/// skips frames and a fast one sees NoNewFrame in between. Decoding happens in read(): not real-time safe.
class VideoSource {
 public:
  /// `path` is a video file, an image, or a numbered pattern of images such as dir/frame_%04d.png. `fps_override` > 0
  /// replaces the file's own frame rate. Returns null with one clear line in `error` when it cannot be read.
  [[nodiscard]] static std::unique_ptr<VideoSource> open(const std::string& path, std::string& error,
                                                         double fps_override = 0);
  VideoSource() = default;
  VideoSource(const VideoSource&) = delete;
  VideoSource& operator=(const VideoSource&) = delete;
  virtual ~VideoSource() = default;

  /// A view of the recording; both views show the same frames. They belong to the source.
  [[nodiscard]] virtual Camera& view(Eye eye) noexcept = 0;

  [[nodiscard]] virtual int width_px() const noexcept = 0;
  [[nodiscard]] virtual int height_px() const noexcept = 0;
  [[nodiscard]] virtual double fps() const noexcept = 0;
  /// What the file says; 0 when it does not. Recordings that were cut short say too much.
  [[nodiscard]] virtual std::uint64_t frame_count() const noexcept = 0;
  /// When frame `sequence` is due.
  [[nodiscard]] virtual TimeNs due_ns(std::uint64_t sequence) const noexcept = 0;
};

}  // namespace tectum
