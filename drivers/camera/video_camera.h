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
  ~VideoSource();

  /// A view of the recording; both views show the same frames. They belong to the source.
  [[nodiscard]] Camera& view(Eye eye) noexcept;

  [[nodiscard]] int width_px() const noexcept;
  [[nodiscard]] int height_px() const noexcept;
  [[nodiscard]] double fps() const noexcept;
  /// What the file says; 0 when it does not. Recordings that were cut short say too much.
  [[nodiscard]] std::uint64_t frame_count() const noexcept;
  /// When frame `sequence` is due.
  [[nodiscard]] TimeNs due_ns(std::uint64_t sequence) const noexcept;

 private:
  struct Impl;
  explicit VideoSource(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
