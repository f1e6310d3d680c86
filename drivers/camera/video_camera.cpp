#include "drivers/camera/video_camera.h"

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
constexpr int kBuffers = 3;        // one held by each view, one to decode into

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

}  // namespace

struct VideoSource::Impl {
  // A frame stays in its buffer as long as a view shows it.
  struct Buffer {
    cv::Mat bgr;
    std::uint64_t sequence = 0;
    int holders = 0;
  };

  class View final : public Camera {
   public:
    explicit View(Impl& source) : source_(source) {}

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
    Impl& source_;
    int held_ = -1;
  };

  [[nodiscard]] TimeNs due_ns(std::uint64_t sequence) const noexcept {
    return static_cast<TimeNs>(std::llround(static_cast<double>(sequence) * 1e9 / fps_));
  }

  // Leaves the newest frame due at `now_ns` in buffers_[newest_]. Ended once a frame is due that is not there.
  CameraStatus decode_up_to(TimeNs now_ns) noexcept {
    try {
      while (!ended_ && due_ns(next_) <= now_ns) {
        if (!capture_.grab()) {
          ended_ = true;
          break;
        }
        ++next_;
        if (due_ns(next_) <= now_ns) {
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

VideoSource::VideoSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoSource::~VideoSource() = default;

std::unique_ptr<VideoSource> VideoSource::open(const std::string& path, std::string& error, double fps_override) {
  error = path_error(path);
  if (!error.empty()) {
    return nullptr;
  }
  silence_decoders();
  auto impl = std::make_unique<Impl>();
  try {
    if (!open_file(impl->capture_, path)) {
      error = path.find('%') != std::string::npos ? "no images match `" + path + "`"
                                                  : "`" + path + "` is not a video or image that OpenCV can read";
      return nullptr;
    }
    impl->width_px_ = cvRound(impl->capture_.get(cv::CAP_PROP_FRAME_WIDTH));
    impl->height_px_ = cvRound(impl->capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
    const double fps = impl->capture_.get(cv::CAP_PROP_FPS);
    const double frames = impl->capture_.get(cv::CAP_PROP_FRAME_COUNT);
    impl->fps_ = fps_override > 0 ? fps_override : std::isfinite(fps) && fps > 0 && fps < 10000 ? fps : kImagesFps;
    impl->frame_count_ = frames > 0 && frames < 1e12 ? static_cast<std::uint64_t>(frames) : 0;
  } catch (const cv::Exception& failure) {
    error = "`" + path + "` cannot be read: " + failure.err;
    return nullptr;
  }
  if (impl->width_px_ <= 0 || impl->height_px_ <= 0) {
    error = "`" + path + "` holds no picture";
    return nullptr;
  }
  return std::unique_ptr<VideoSource>(new VideoSource(std::move(impl)));
}

Camera& VideoSource::view(Eye eye) noexcept { return impl_->views_[static_cast<std::size_t>(eye)]; }
int VideoSource::width_px() const noexcept { return impl_->width_px_; }
int VideoSource::height_px() const noexcept { return impl_->height_px_; }
double VideoSource::fps() const noexcept { return impl_->fps_; }
std::uint64_t VideoSource::frame_count() const noexcept { return impl_->frame_count_; }
TimeNs VideoSource::due_ns(std::uint64_t sequence) const noexcept { return impl_->due_ns(sequence); }

}  // namespace tectum
