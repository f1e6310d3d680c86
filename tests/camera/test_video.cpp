#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "drivers/camera/video_camera.h"
#include "drivers/camera/video_writer.h"

using namespace tectum;
namespace fs = std::filesystem;

namespace {

constexpr int kSide = 160;
constexpr int kFrames = 20;

// A folder of its own for each test case, gone afterwards.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "tectum_video_XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    folder_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  fs::path folder_;
};

cv::Point2d dot_at(int frame, int eye) { return {40.0 + 3 * frame, 60.0 + 20 * eye + 1.5 * frame}; }

cv::Mat picture_of(int frame, int eye) {
  cv::Mat picture(kSide, kSide, CV_8UC3, cv::Scalar(12, 12, 12));
  const cv::Point2d dot = dot_at(frame, eye);
  cv::circle(picture, cv::Point(cvRound(dot.x * 16), cvRound(dot.y * 16)), 4 * 16, cv::Scalar(40, 40, 255), cv::FILLED,
             cv::LINE_AA, 4);
  return picture;
}

Frame frame_of(const cv::Mat& picture) { return {picture.data, picture.cols, picture.rows, picture.step, 0, 0}; }

cv::Point2d redness_centroid(const Frame& frame, int x0, int x1) {
  double sum = 0, sum_x = 0, sum_y = 0;
  for (int y = 0; y < frame.height_px; ++y) {
    const std::uint8_t* row = frame.bgr + static_cast<std::size_t>(y) * frame.stride_bytes;
    for (int x = x0; x < x1; ++x) {
      const double red = row[3 * x + 2] - std::max(row[3 * x], row[3 * x + 1]);
      if (red > 60) {
        sum += red;
        sum_x += red * (x - x0);
        sum_y += red * y;
      }
    }
  }
  REQUIRE(sum > 0);
  return {sum_x / sum, sum_y / sum};
}

void write_film(const std::string& path, VideoLayout layout, double fps = 45) {
  std::string error;
  auto writer = EyeVideoWriter::open({path, layout, fps, kSide, kSide}, error);
  REQUIRE_MESSAGE(writer, error);
  for (int k = 0; k < kFrames; ++k) {
    const cv::Mat left = picture_of(k, 0), right = picture_of(k, 1);
    writer->write(frame_of(left), frame_of(right));
  }
  REQUIRE(writer->close());
}

std::string open_error(const std::string& path) {
  std::string error;
  CHECK(VideoSource::open(path, error) == nullptr);
  CHECK(error.find('\n') == std::string::npos);
  return error;
}

}  // namespace

TEST_CASE("a film written side by side is read again with the dots within a pixel") {
  const Scratch scratch;
  for (const char* name : {"film.mp4", "film.avi", "film.mkv"}) {
    CAPTURE(name);
    write_film(scratch.path(name), VideoLayout::SideBySide);
    std::string error;
    auto source = VideoSource::open(scratch.path(name), error);
    REQUIRE_MESSAGE(source, error);
    CHECK(source->width_px() == 2 * kSide);
    CHECK(source->height_px() == kSide);
    CHECK(source->fps() == doctest::Approx(45));
    Frame frame;
    for (int k = 0; k < kFrames; ++k) {
      CAPTURE(k);
      REQUIRE(source->view(Eye::Left).read(source->due_ns(static_cast<std::uint64_t>(k)), frame) ==
              CameraStatus::NewFrame);
      CHECK(frame.sequence == static_cast<std::uint64_t>(k));
      for (int eye = 0; eye < 2; ++eye) {
        const cv::Point2d seen = redness_centroid(frame, eye * kSide, (eye + 1) * kSide);
        CHECK(std::abs(seen.x - dot_at(k, eye).x) < 1);
        CHECK(std::abs(seen.y - dot_at(k, eye).y) < 1);
      }
    }
    CHECK(source->view(Eye::Left).read(source->due_ns(kFrames), frame) == CameraStatus::Ended);
    CHECK(source->view(Eye::Left).read(source->due_ns(kFrames + 9), frame) == CameraStatus::Ended);
  }
}

TEST_CASE("a file an eye holds that eye's pictures alone") {
  const Scratch scratch;
  write_film(scratch.path("film.mp4"), VideoLayout::OneFileAnEye);
  CHECK_FALSE(fs::exists(scratch.path("film.mp4")));
  for (int eye = 0; eye < 2; ++eye) {
    std::string error;
    auto source = VideoSource::open(scratch.path(eye == 0 ? "film.left.mp4" : "film.right.mp4"), error);
    REQUIRE_MESSAGE(source, error);
    Frame frame;
    REQUIRE(source->view(Eye::Left).read(0, frame) == CameraStatus::NewFrame);
    CHECK(frame.width_px == kSide);
    CHECK(std::abs(redness_centroid(frame, 0, kSide).y - dot_at(0, eye).y) < 1);
  }
}

TEST_CASE("one file serves both eyes, each of which gets every frame once") {
  const Scratch scratch;
  write_film(scratch.path("film.avi"), VideoLayout::SideBySide, 25);
  std::string error;
  auto source = VideoSource::open(scratch.path("film.avi"), error);
  REQUIRE(source);
  Frame left, right;
  for (int k = 0; k < kFrames; ++k) {
    const TimeNs now_ns = 40'000'000LL * k;
    REQUIRE(source->view(Eye::Left).read(now_ns, left) == CameraStatus::NewFrame);
    REQUIRE(source->view(Eye::Right).read(now_ns, right) == CameraStatus::NewFrame);
    CHECK(left.bgr == right.bgr);
    CHECK(left.captured_ns == now_ns);
    CHECK(source->view(Eye::Left).read(now_ns + 37'000'000, left) == CameraStatus::NoNewFrame);
  }
}

TEST_CASE("a frame stays as it was until its own view reads again, whatever the other view does") {
  const Scratch scratch;
  write_film(scratch.path("film.avi"), VideoLayout::SideBySide, 25);
  std::string error;
  auto source = VideoSource::open(scratch.path("film.avi"), error);
  REQUIRE(source);
  Frame left, right;
  REQUIRE(source->view(Eye::Left).read(0, left) == CameraStatus::NewFrame);
  const cv::Point2d before = redness_centroid(left, 0, kSide);
  for (int k = 0; k < 8; ++k) {
    REQUIRE(source->view(Eye::Right).read(40'000'000LL * k, right) == CameraStatus::NewFrame);
  }
  CHECK(redness_centroid(left, 0, kSide) == before);
  CHECK(redness_centroid(right, 0, kSide).x > before.x + 15);
}

TEST_CASE("a slow loop gets the newest frame that is due and skips the others") {
  const Scratch scratch;
  write_film(scratch.path("film.avi"), VideoLayout::SideBySide, 25);
  std::string error;
  auto source = VideoSource::open(scratch.path("film.avi"), error);
  REQUIRE(source);
  Frame frame;
  REQUIRE(source->view(Eye::Left).read(410'000'000, frame) == CameraStatus::NewFrame);
  CHECK(frame.sequence == 10);
  CHECK(frame.captured_ns == 400'000'000);
  CHECK(std::abs(redness_centroid(frame, 0, kSide).x - dot_at(10, 0).x) < 1);
}

TEST_CASE("a numbered folder of images is a recording, at 25 frames a second or as asked") {
  const Scratch scratch;
  for (int k = 0; k < 5; ++k) {
    REQUIRE(cv::imwrite(scratch.path("frame_" + std::to_string(1000 + k).substr(1) + ".png"), picture_of(k, 0)));
  }
  std::string error;
  auto source = VideoSource::open(scratch.path("frame_%03d.png"), error);
  REQUIRE_MESSAGE(source, error);
  CHECK(source->fps() == 25);
  Frame frame;
  for (int k = 0; k < 5; ++k) {
    REQUIRE(source->view(Eye::Right).read(source->due_ns(static_cast<std::uint64_t>(k)), frame) ==
            CameraStatus::NewFrame);
    CHECK(std::abs(redness_centroid(frame, 0, kSide).x - dot_at(k, 0).x) < 0.2);
  }
  CHECK(source->view(Eye::Right).read(source->due_ns(5), frame) == CameraStatus::Ended);
  auto faster = VideoSource::open(scratch.path("frame_%03d.png"), error, 50);
  REQUIRE(faster);
  CHECK(faster->due_ns(1) == 20'000'000);
}

TEST_CASE("what cannot be read gets one line that says why") {
  const Scratch scratch;
  std::ofstream(scratch.path("empty.avi"));
  std::ofstream(scratch.path("text.mp4")) << "this is no film\n" << std::string(5000, 'x');
  CHECK(open_error(scratch.path("absent.mp4")).find("no such file") != std::string::npos);
  CHECK(open_error(scratch.path("")).find("is a directory") != std::string::npos);
  CHECK(open_error(scratch.path("empty.avi")).find("is empty") != std::string::npos);
  CHECK(open_error(scratch.path("text.mp4")).find("is not a video") != std::string::npos);
  CHECK(open_error(scratch.path("no_%02d.png")).find("no images match") != std::string::npos);
  CHECK(open_error("/dev/null").find("not a regular file") != std::string::npos);
}

TEST_CASE("a film cut short ends early instead of failing") {
  const Scratch scratch;
  write_film(scratch.path("film.avi"), VideoLayout::SideBySide, 25);
  fs::resize_file(scratch.path("film.avi"), fs::file_size(scratch.path("film.avi")) / 2);
  std::string error;
  auto source = VideoSource::open(scratch.path("film.avi"), error);
  REQUIRE_MESSAGE(source, error);
  Frame frame;
  int seen = 0;
  CameraStatus status = CameraStatus::NewFrame;
  for (int k = 0; k < 2 * kFrames && status == CameraStatus::NewFrame; ++k) {
    status = source->view(Eye::Left).read(source->due_ns(static_cast<std::uint64_t>(k)), frame);
    seen += status == CameraStatus::NewFrame ? 1 : 0;
  }
  CHECK(status == CameraStatus::Ended);
  CHECK(seen > 0);
  CHECK(seen < kFrames);
}

TEST_CASE("what cannot be written gets one line that says why") {
  const Scratch scratch;
  const auto error_of = [](const VideoWriterParams& params) {
    std::string error;
    CHECK(EyeVideoWriter::open(params, error) == nullptr);
    return error;
  };
  CHECK(error_of({scratch.path("film.txt"), VideoLayout::SideBySide, 45, 64, 64}).find(".mp4") != std::string::npos);
  CHECK(error_of({scratch.path("absent/film.mp4"), VideoLayout::SideBySide, 45, 64, 64}).find("no folder") !=
        std::string::npos);
  CHECK(error_of({scratch.path("film.mp4"), VideoLayout::SideBySide, 45, 0, 64}).find("size") != std::string::npos);
}

TEST_CASE("an eye without a new frame keeps its last picture, and odd sizes are padded") {
  const Scratch scratch;
  std::string error;
  auto writer = EyeVideoWriter::open({scratch.path("odd.mp4"), VideoLayout::SideBySide, 30, 101, 75}, error);
  REQUIRE_MESSAGE(writer, error);
  cv::Mat left(75, 101, CV_8UC3, cv::Scalar(0, 0, 200));
  writer->write(frame_of(left), {});
  writer->write({}, {});
  REQUIRE(writer->close());
  auto source = VideoSource::open(scratch.path("odd.mp4"), error);
  REQUIRE_MESSAGE(source, error);
  CHECK(source->width_px() == 204);
  CHECK(source->height_px() == 76);
  Frame frame;
  REQUIRE(source->view(Eye::Left).read(source->due_ns(1), frame) == CameraStatus::NewFrame);
  const std::uint8_t* row = frame.bgr + 40 * frame.stride_bytes;
  CHECK(row[3 * 50 + 2] > 180);  // left eye, red
  CHECK(row[3 * 150 + 2] < 20);  // right eye, black
}
