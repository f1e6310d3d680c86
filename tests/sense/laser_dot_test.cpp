// The retina on a real camera recording: a green laser dot of 4 to 6 pixels on cloth, a saturated window at the right
// edge, a green box drawn into seven frames, and the true dot position of every frame. The recording is not part of
// the project; the test is skipped where it is absent.

#include <doctest/doctest.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "runtime/sense/retina.h"
#include "tests/sense/retina_fixture.h"
#include "tests/support/laser_dot.h"

using namespace tectum;

namespace {

constexpr int kCameraWidthPx = 320, kCameraHeightPx = 240;
constexpr float kReferencePerCameraPx = 3;  // a reference frame of 960 x 720 shows the whole picture

/// Square fields around (x, y): one camera pixel wide in the middle, doubling in size outwards.
std::vector<FieldRecord> foveated_sheet(float x, float y) {
  std::vector<FieldRecord> fields;
  const auto tile = [&](float inner, float outer, float size) {
    for (float v = -outer; v < outer; v += size) {
      for (float u = -outer; u < outer; u += size) {
        const bool is_inside = u >= -inner && u < inner && v >= -inner && v < inner;
        if (!is_inside) {
          fields.push_back({x + u, y + v, x + u + size, y + v + size});
        }
      }
    }
  };
  tile(0, 24, kReferencePerCameraPx);
  for (float inner = 24; inner < 480; inner *= 2) {
    tile(inner, 2 * inner, inner / 2);
  }
  return fields;
}

void check_sheet(const std::string& folder, const std::string& sheet, const std::vector<FieldRecord>& fields) {
  const std::vector<DotTruth> truths = read_dot_truth(folder + "laser_dot_truth.csv");
  cv::VideoCapture video(folder + "laser_dot.avi");
  REQUIRE(video.isOpened());
  RetinaRecord record{};
  record.frame_width = static_cast<std::uint32_t>(kCameraWidthPx * kReferencePerCameraPx);
  record.frame_height = static_cast<std::uint32_t>(kCameraHeightPx * kReferencePerCameraPx);
  record.lit_channel = LitChannel::GreenOverRedBlue;
  record.lit_above = 20;
  Retina retina(image_of_retina(record, fields), 0);
  REQUIRE(retina.prepare(kCameraWidthPx, kCameraHeightPx));

  const CameraToReference map{.reference_per_camera_px = kReferencePerCameraPx};
  DotScore without_boxes, all;
  cv::Mat image;
  for (const DotTruth& truth : truths) {
    REQUIRE(video.read(image));
    REQUIRE(image.cols == kCameraWidthPx);
    REQUIRE(retina.encode(
        {.bgr = image.data, .width_px = image.cols, .height_px = image.rows, .stride_bytes = image.step}));
    all.add(truth, retina.active(), fields, map);
    if (!truth.has_drawn_box) {
      without_boxes.add(truth, retina.active(), fields, map);
    }
  }
  for (const auto& [name, score] :
       {std::pair{std::string("without the drawn boxes"), without_boxes}, {"all frames", all}}) {
    MESSAGE(sheet, ", ", name, ": ", score.text());
  }
  CHECK(without_boxes.visible == 253);
  CHECK(without_boxes.off == 95);
  CHECK(without_boxes.both >= 0.95 * without_boxes.visible);
  CHECK(without_boxes.silent == without_boxes.off);
}

}  // namespace

TEST_CASE("a real laser dot activates the fields that contain it, and the window beside it none") {
  const std::string folder = laser_dot_folder();
  if (folder.empty()) {
    MESSAGE("skipped: the recording is not there");
    return;
  }
  check_sheet(folder, "foveated sheet", foveated_sheet(480, 360));
  check_sheet(folder, "even grid of 10 px fields", grid_of_fields(32, 24, 960, 720));
}
