// Writes what both eyes see to a video file that VideoCapture, and a browser, can open again.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "runtime/ports/frame.h"

namespace tectum {

enum class VideoLayout {
  SideBySide,    // one file, left eye on the left
  OneFileAnEye,  // out.mp4 becomes out.left.mp4 and out.right.mp4
};

struct VideoWriterParams {
  std::string path;  // .mp4, .m4v, .mov, .mkv or .avi
  VideoLayout layout = VideoLayout::SideBySide;
  double fps = 45;
  int width_px = 0;  // of one eye
  int height_px = 0;
};

/// Not real-time safe: encodes and writes to a file.
class EyeVideoWriter {
 public:
  /// Null with one clear line in `error` when the file cannot be written.
  [[nodiscard]] static std::unique_ptr<EyeVideoWriter> open(const VideoWriterParams& params, std::string& error);
  EyeVideoWriter() = default;
  EyeVideoWriter(const EyeVideoWriter&) = delete;
  EyeVideoWriter& operator=(const EyeVideoWriter&) = delete;
  virtual ~EyeVideoWriter() = default;

  /// One turn of the loop. A frame without pixels, or of another size, repeats that eye's last picture (black at
  /// first).
  virtual void write(const Frame& left, const Frame& right) = 0;
  /// Finishes the files. False when nothing could be written; also done by the destructor.
  [[nodiscard]] virtual bool close() = 0;

  /// The file or files, for the user.
  [[nodiscard]] virtual const std::string& left_path() const noexcept = 0;
  [[nodiscard]] virtual const std::string& right_path() const noexcept = 0;
};

}  // namespace tectum
