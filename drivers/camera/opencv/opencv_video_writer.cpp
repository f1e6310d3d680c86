#include "drivers/camera/video_library.h"
#include "drivers/camera/video_writer.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>
#include <vector>

namespace tectum {
namespace {

namespace fs = std::filesystem;

// Codecs by container, best first. H.264 plays in browsers; MPEG-4 part 2 is in every FFmpeg; Motion JPEG is in OpenCV.
std::vector<int> codecs_for(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const int h264 = cv::VideoWriter::fourcc('a', 'v', 'c', '1');
  const int mpeg4 = cv::VideoWriter::fourcc('m', 'p', '4', 'v');
  const int motion_jpeg = cv::VideoWriter::fourcc('M', 'J', 'P', 'G');
  if (extension == ".avi") {
    return {motion_jpeg};
  }
  if (extension == ".mp4" || extension == ".m4v" || extension == ".mov") {
    return {h264, mpeg4};
  }
  if (extension == ".mkv") {
    return {cv::VideoWriter::fourcc('H', '2', '6', '4'), motion_jpeg};
  }
  return {};
}

std::string eye_path(const std::string& path, const char* eye) {
  const fs::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + "." + eye + whole.extension().string())).string();
}

bool open_any(cv::VideoWriter& writer, const std::string& path, double fps, cv::Size size) {
  for (const int codec : codecs_for(path)) {
    if (writer.open(path, cv::CAP_FFMPEG, codec, fps, size, true) || writer.open(path, codec, fps, size, true)) {
      return true;
    }
  }
  return false;
}

std::string refusal(const VideoWriterParams& params) {
  if (codecs_for(params.path).empty()) {
    return "`" + params.path + "`: the name of a video to write ends in .mp4, .mkv, .mov or .avi";
  }
  if (params.width_px <= 0 || params.height_px <= 0 || !(params.fps > 0)) {
    return "`" + params.path + "`: a video needs a picture size and a frame rate above 0";
  }
  std::error_code failure;
  const fs::path folder = fs::path(params.path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, failure)) {
    return "`" + params.path + "`: there is no folder `" + folder.string() + "`";
  }
  if (fs::is_directory(params.path, failure)) {
    return "`" + params.path + "` is a directory";
  }
  return "";
}

class OpenCvVideoWriter final : public EyeVideoWriter {
 public:
  [[nodiscard]] bool open(const VideoWriterParams& params, std::string& error);

  void write(const Frame& left, const Frame& right) override;
  [[nodiscard]] bool close() override;
  [[nodiscard]] const std::string& left_path() const noexcept override { return paths_[0]; }
  [[nodiscard]] const std::string& right_path() const noexcept override { return paths_[1]; }

 private:
  void take(const Frame& frame, cv::Mat& half) const {
    if (frame.bgr == nullptr || frame.width_px != params_.width_px || frame.height_px != params_.height_px) {
      return;
    }
    for (int y = 0; y < frame.height_px; ++y) {
      const std::uint8_t* row = frame.bgr + static_cast<std::size_t>(y) * frame.stride_bytes;
      std::copy_n(row, 3 * frame.width_px, half.ptr(y));
    }
  }

  VideoWriterParams params_;
  std::array<std::string, 2> paths_;
  std::array<cv::VideoWriter, 2> writers_;  // the second one only for a file an eye
  // Both eyes side by side; for a file an eye, each its own half. Even sizes: H.264 halves its colours' resolution.
  cv::Mat canvas_;
  std::array<cv::Mat, 2> halves_;
  std::uint64_t written_ = 0;
};

bool OpenCvVideoWriter::open(const VideoWriterParams& params, std::string& error) {
  error = refusal(params);
  if (!error.empty()) {
    return false;
  }
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  params_ = params;
  const bool together = params.layout == VideoLayout::SideBySide;
  const cv::Size half_px((params.width_px + 1) / 2 * 2, (params.height_px + 1) / 2 * 2);
  canvas_ = cv::Mat::zeros(half_px.height, 2 * half_px.width, CV_8UC3);
  for (int eye = 0; eye < 2; ++eye) {
    auto& half = halves_[static_cast<std::size_t>(eye)];
    half = together ? canvas_(cv::Rect({eye * half_px.width, 0}, half_px)) : cv::Mat::zeros(half_px, CV_8UC3);
  }
  paths_ = {together ? params.path : eye_path(params.path, "left"),
            together ? params.path : eye_path(params.path, "right")};
  try {
    for (std::size_t file = 0; file < (together ? 1U : 2U); ++file) {
      if (!open_any(writers_[file], paths_[file], params.fps, together ? canvas_.size() : half_px)) {
        error = "`" + paths_[file] + "` cannot be written";
        return false;
      }
    }
  } catch (const cv::Exception& failure) {
    error = "`" + params.path + "` cannot be written: " + failure.err;
    return false;
  }
  return true;
}

void OpenCvVideoWriter::write(const Frame& left, const Frame& right) {
  take(left, halves_[0]);
  take(right, halves_[1]);
  if (params_.layout == VideoLayout::SideBySide) {
    writers_[0].write(canvas_);
  } else {
    writers_[0].write(halves_[0]);
    writers_[1].write(halves_[1]);
  }
  ++written_;
}

bool OpenCvVideoWriter::close() {
  writers_[0].release();
  writers_[1].release();
  std::error_code failure;
  return written_ > 0 && std::all_of(paths_.begin(), paths_.end(), [&failure](const std::string& path) {
           const auto bytes = fs::file_size(path, failure);
           return !failure && bytes > 0;
         });
}

}  // namespace

extern "C" EyeVideoWriter* tectum_open_video_writer(const VideoWriterParams& params, std::string& error) {
  auto writer = std::make_unique<OpenCvVideoWriter>();
  return writer->open(params, error) ? writer.release() : nullptr;
}

}  // namespace tectum
