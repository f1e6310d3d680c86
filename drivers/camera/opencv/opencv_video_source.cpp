#include "drivers/camera/video_camera.h"
#include "drivers/camera/video_library.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

namespace tectum {
namespace {

constexpr double kImagesFps = 25;  // image sequences carry no rate
// A loop whose period is rounded to a nanosecond must not fall behind the recording by a frame.
constexpr double kDueTolerance = 1.0 / 16;  // of a frame
constexpr int kBuffers = 3;                 // one held by each view, one to decode into

// OpenCV and FFmpeg print their own guesses about a bad file; one line of ours is enough.
void silence_decoders() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);  // AV_LOG_QUIET, unless the user asks for more
}

// Those of OpenCV's readers that read files. CAP_ANY would also look for cameras on every bus, and some of those
// drivers leak; GStreamer prints a page about a file that it cannot read, and FFmpeg reads what it can.
bool open_file(cv::VideoCapture& capture, const std::string& path) {
  for (const int reader : {cv::CAP_FFMPEG, cv::CAP_IMAGES, cv::CAP_OPENCV_MJPEG}) {
    if (capture.open(path, reader)) {
      return true;
    }
  }
  return false;
}

// Why a path cannot be a recording; empty when it may be one.
std::string path_error(const std::string& path) {
  std::error_code failure;
  if (path.empty()) {
    return "no file given";
  }
  if (std::filesystem::is_directory(path, failure)) {
    return "`" + path + "` is a directory; give a file, or the images in it as `" + path + "/name_%04d.png`";
  }
  const bool pattern = path.find('%') != std::string::npos;
  if (!std::filesystem::exists(path, failure)) {
    return pattern ? "" : "`" + path + "`: no such file";
  }
  if (!std::filesystem::is_regular_file(path, failure)) {
    return "`" + path + "` is not a regular file";
  }
  if (std::filesystem::file_size(path, failure) == 0) {
    return "`" + path + "` is empty";
  }
  return "";
}

class OpenCvVideoSource final : public VideoSource {
 public:
  [[nodiscard]] bool open(const std::string& path, std::string& error, double fps_override);

  [[nodiscard]] Camera& view(Eye eye) noexcept override { return views_[static_cast<std::size_t>(eye)]; }
  [[nodiscard]] int width_px() const noexcept override { return width_px_; }
  [[nodiscard]] int height_px() const noexcept override { return height_px_; }
  [[nodiscard]] double fps() const noexcept override { return fps_; }
  [[nodiscard]] std::uint64_t frame_count() const noexcept override { return frame_count_; }
  [[nodiscard]] TimeNs due_ns(std::uint64_t sequence) const noexcept override {
    return static_cast<TimeNs>(std::llround(static_cast<double>(sequence) * 1e9 / fps_));
  }

 private:
  // A frame stays in its buffer as long as a view shows it.
  struct Buffer {
    cv::Mat bgr;
    std::uint64_t sequence = 0;
    int holders = 0;
  };

  class View final : public Camera {
   public:
    explicit View(OpenCvVideoSource& source) : source_(source) {}

    CameraStatus read(TimeNs now_ns, Frame& out) noexcept override {
      const CameraStatus status = source_.decode_up_to(now_ns);
      if (status == CameraStatus::Ended || status == CameraStatus::Failed) {
        return status;
      }
      if (source_.newest_ < 0 || source_.newest_ == held_) {
        return CameraStatus::NoNewFrame;
      }
      if (held_ >= 0) {
        --source_.buffers_[static_cast<std::size_t>(held_)].holders;
      }
      held_ = source_.newest_;
      Buffer& buffer = source_.buffers_[static_cast<std::size_t>(held_)];
      ++buffer.holders;
      out = {buffer.bgr.data, buffer.bgr.cols, buffer.bgr.rows, buffer.bgr.step, source_.due_ns(buffer.sequence),
             buffer.sequence};
      return CameraStatus::NewFrame;
    }

   private:
    OpenCvVideoSource& source_;
    int held_ = -1;
  };

  // Leaves the newest frame due at `now_ns` in buffers_[newest_]. Ended once a frame is due that is not there.
  CameraStatus decode_up_to(TimeNs now_ns) noexcept {
    try {
      const TimeNs horizon_ns = now_ns + static_cast<TimeNs>(kDueTolerance * 1e9 / fps_);
      while (!ended_ && due_ns(next_) <= horizon_ns) {
        if (!capture_.grab()) {
          ended_ = true;
          break;
        }
        ++next_;
        if (due_ns(next_) <= horizon_ns) {
          continue;  // superseded before anyone could see it
        }
        const int free = free_buffer();
        Buffer& buffer = buffers_[static_cast<std::size_t>(free)];
        if (!capture_.retrieve(buffer.bgr) || !usable(buffer.bgr)) {
          return CameraStatus::Failed;
        }
        buffer.sequence = next_ - 1;
        newest_ = free;
      }
    } catch (const cv::Exception&) {
      ended_ = true;
      return CameraStatus::Failed;
    }
    return ended_ ? CameraStatus::Ended : CameraStatus::NewFrame;
  }

  [[nodiscard]] int free_buffer() const noexcept {
    int free = 0;
    while (buffers_[static_cast<std::size_t>(free)].holders > 0) {
      ++free;  // two views hold at most two of three
    }
    return free;
  }

  [[nodiscard]] bool usable(const cv::Mat& picture) const noexcept {
    return picture.type() == CV_8UC3 && picture.cols == width_px_ && picture.rows == height_px_;
  }

  cv::VideoCapture capture_;
  double fps_ = kImagesFps;
  int width_px_ = 0, height_px_ = 0;
  std::uint64_t frame_count_ = 0;
  std::uint64_t next_ = 0;  // sequence of the frame to grab next
  bool ended_ = false;
  int newest_ = -1;
  std::array<Buffer, kBuffers> buffers_;
  std::array<View, kEyeCount> views_ = {View(*this), View(*this)};
};

bool OpenCvVideoSource::open(const std::string& path, std::string& error, double fps_override) {
  error = path_error(path);
  if (!error.empty()) {
    return false;
  }
  silence_decoders();
  try {
    if (!open_file(capture_, path)) {
      error = path.find('%') != std::string::npos ? "no images match `" + path + "`"
                                                  : "`" + path + "` is not a video or image that OpenCV can read";
      return false;
    }
    width_px_ = cvRound(capture_.get(cv::CAP_PROP_FRAME_WIDTH));
    height_px_ = cvRound(capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
    const double fps = capture_.get(cv::CAP_PROP_FPS);
    const double frames = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    fps_ = fps_override > 0 ? fps_override : std::isfinite(fps) && fps > 0 && fps < 10000 ? fps : kImagesFps;
    frame_count_ = frames > 0 && frames < 1e12 ? static_cast<std::uint64_t>(frames) : 0;
  } catch (const cv::Exception& failure) {
    error = "`" + path + "` cannot be read: " + failure.err;
    return false;
  }
  if (width_px_ <= 0 || height_px_ <= 0) {
    error = "`" + path + "` holds no picture";
    return false;
  }
  return true;
}

}  // namespace

extern "C" VideoSource* tectum_open_video_source(const std::string& path, std::string& error, double fps_override) {
  auto source = std::make_unique<OpenCvVideoSource>();
  return source->open(path, error, fps_override) ? source.release() : nullptr;
}

}  // namespace tectum
