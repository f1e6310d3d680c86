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

}  // namespace

struct EyeVideoWriter::Impl {
  VideoWriterParams params;
  std::array<std::string, 2> paths;
  std::array<cv::VideoWriter, 2> writers;  // the second one only for a file an eye
  // Both eyes side by side; for a file an eye, each its own half. Even sizes: H.264 halves its colours' resolution.
  cv::Mat canvas;
  std::array<cv::Mat, 2> halves;
  std::uint64_t written = 0;

  void take(const Frame& frame, cv::Mat& half) const {
    if (frame.bgr == nullptr || frame.width_px != params.width_px || frame.height_px != params.height_px) {
      return;
    }
    for (int y = 0; y < frame.height_px; ++y) {
      const std::uint8_t* row = frame.bgr + static_cast<std::size_t>(y) * frame.stride_bytes;
      std::copy_n(row, 3 * frame.width_px, half.ptr(y));
    }
  }
};

EyeVideoWriter::EyeVideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
EyeVideoWriter::~EyeVideoWriter() = default;

std::unique_ptr<EyeVideoWriter> EyeVideoWriter::open(const VideoWriterParams& params, std::string& error) {
  error = refusal(params);
  if (!error.empty()) {
    return nullptr;
  }
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  auto impl = std::make_unique<Impl>();
  impl->params = params;
  const bool together = params.layout == VideoLayout::SideBySide;
  const cv::Size half_px((params.width_px + 1) / 2 * 2, (params.height_px + 1) / 2 * 2);
  impl->canvas = cv::Mat::zeros(half_px.height, 2 * half_px.width, CV_8UC3);
  for (int eye = 0; eye < 2; ++eye) {
    auto& half = impl->halves[static_cast<std::size_t>(eye)];
    half = together ? impl->canvas(cv::Rect({eye * half_px.width, 0}, half_px)) : cv::Mat::zeros(half_px, CV_8UC3);
  }
  impl->paths = {together ? params.path : eye_path(params.path, "left"),
                 together ? params.path : eye_path(params.path, "right")};
  try {
    for (std::size_t file = 0; file < (together ? 1U : 2U); ++file) {
      if (!open_any(impl->writers[file], impl->paths[file], params.fps, together ? impl->canvas.size() : half_px)) {
        error = "`" + impl->paths[file] + "` cannot be written";
        return nullptr;
      }
    }
  } catch (const cv::Exception& failure) {
    error = "`" + params.path + "` cannot be written: " + failure.err;
    return nullptr;
  }
  return std::unique_ptr<EyeVideoWriter>(new EyeVideoWriter(std::move(impl)));
}

void EyeVideoWriter::write(const Frame& left, const Frame& right) {
  impl_->take(left, impl_->halves[0]);
  impl_->take(right, impl_->halves[1]);
  if (impl_->params.layout == VideoLayout::SideBySide) {
    impl_->writers[0].write(impl_->canvas);
  } else {
    impl_->writers[0].write(impl_->halves[0]);
    impl_->writers[1].write(impl_->halves[1]);
  }
  ++impl_->written;
}

bool EyeVideoWriter::close() {
  impl_->writers[0].release();
  impl_->writers[1].release();
  std::error_code failure;
  return impl_->written > 0 &&
         std::all_of(impl_->paths.begin(), impl_->paths.end(), [&failure](const std::string& path) {
           const auto bytes = fs::file_size(path, failure);
           return !failure && bytes > 0;
         });
}

const std::string& EyeVideoWriter::left_path() const noexcept { return impl_->paths[0]; }
const std::string& EyeVideoWriter::right_path() const noexcept { return impl_->paths[1]; }

}  // namespace tectum
