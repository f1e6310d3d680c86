// The retina on a real camera recording: a green laser dot of 4 to 6 pixels on cloth, a saturated window at the right
// edge, a green box drawn into seven frames, and the true dot position of every frame. The recording is not part of
// the project; the test is skipped where it is absent.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "runtime/sense/retina.h"
#include "tests/sense/retina_fixture.h"

using namespace tectum;

namespace {

constexpr int kCameraWidthPx = 320, kCameraHeightPx = 240;
constexpr float kReferencePerCameraPx = 3;  // a reference frame of 960 x 720 shows the whole picture
// A field is away from the dot when it has no point within this distance of the true position: the dot's radius of
// 3 px, its blur, and the half pixel that the truth is uncertain by.
constexpr float kDotDiscRadiusPx = 6;

struct Truth {
  bool is_visible = false, has_drawn_box = false;
  float x_px = 0, y_px = 0;
};

std::vector<Truth> read_truth(const std::string& path) {
  std::ifstream file(path);
  std::vector<Truth> truths;
  std::string line;
  std::getline(file, line);  // frame,x_px,y_px,dot_visible,at_image_edge,green_box_drawn
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<std::string> cell;
    for (std::string text; std::getline(cells, text, ',');) {
      cell.push_back(text);
    }
    REQUIRE(cell.size() == 6);
    Truth truth{.is_visible = cell[3] == "1", .has_drawn_box = cell[5].starts_with('1')};
    if (truth.is_visible) {
      truth.x_px = std::stof(cell[1]);
      truth.y_px = std::stof(cell[2]);
    }
    truths.push_back(truth);
  }
  return truths;
}

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

/// Squared distance from a point to a rectangle.
float distance2(const FieldRecord& f, float x, float y) {
  const float dx = std::max({f.x0 - x, x - f.x1, 0.0F}), dy = std::max({f.y0 - y, y - f.y1, 0.0F});
  return dx * dx + dy * dy;
}

struct Score {
  int visible = 0, contained = 0, nothing_away = 0, both = 0, off = 0, silent = 0;
};

void score_frame(const Truth& truth, std::span<const std::uint32_t> active, const std::vector<FieldRecord>& fields,
                 Score& score) {
  if (!truth.is_visible) {
    ++score.off;
    score.silent += active.empty() ? 1 : 0;
    return;
  }
  // Pixel 0's centre lies at 0.5 of the half-open frame.
  const float x = (truth.x_px + 0.5F) * kReferencePerCameraPx, y = (truth.y_px + 0.5F) * kReferencePerCameraPx;
  const float radius = kDotDiscRadiusPx * kReferencePerCameraPx;
  bool is_contained = false, is_away = false;
  for (const std::uint32_t k : active) {
    const FieldRecord& f = fields[k];
    is_contained = is_contained || (x >= f.x0 && x < f.x1 && y >= f.y0 && y < f.y1);
    is_away = is_away || distance2(f, x, y) > radius * radius;
  }
  ++score.visible;
  score.contained += is_contained ? 1 : 0;
  score.nothing_away += is_away ? 0 : 1;
  score.both += is_contained && !is_away ? 1 : 0;
}

void check_sheet(const std::string& folder, const std::string& sheet, const std::vector<FieldRecord>& fields) {
  const std::vector<Truth> truths = read_truth(folder + "laser_dot_truth.csv");
  cv::VideoCapture video(folder + "laser_dot.avi");
  REQUIRE(video.isOpened());
  RetinaRecord record{};
  record.frame_width = static_cast<std::uint32_t>(kCameraWidthPx * kReferencePerCameraPx);
  record.frame_height = static_cast<std::uint32_t>(kCameraHeightPx * kReferencePerCameraPx);
  record.lit_channel = LitChannel::GreenOverRedBlue;
  record.lit_above = 20;
  Retina retina(image_of_retina(record, fields), 0);
  REQUIRE(retina.prepare(kCameraWidthPx, kCameraHeightPx));

  Score without_boxes, all;
  cv::Mat image;
  for (const Truth& truth : truths) {
    REQUIRE(video.read(image));
    REQUIRE(image.cols == kCameraWidthPx);
    REQUIRE(retina.encode(
        {.bgr = image.data, .width_px = image.cols, .height_px = image.rows, .stride_bytes = image.step}));
    score_frame(truth, retina.active(), fields, all);
    if (!truth.has_drawn_box) {
      score_frame(truth, retina.active(), fields, without_boxes);
    }
  }
  for (const auto& [name, score] :
       {std::pair{std::string("without the drawn boxes"), without_boxes}, {"all frames", all}}) {
    MESSAGE(sheet, ", ", name, ": ", score.both, " of ", score.visible,
            " visible dots seen and nothing else (contained ", score.contained, ", nothing away ", score.nothing_away,
            "); silent in ", score.silent, " of ", score.off, " frames without a dot");
  }
  CHECK(without_boxes.visible == 253);
  CHECK(without_boxes.off == 95);
  CHECK(without_boxes.both >= 0.95 * without_boxes.visible);
  CHECK(without_boxes.silent == without_boxes.off);
}

}  // namespace

TEST_CASE("a real laser dot activates the fields that contain it, and the window beside it none") {
  const std::string folder = TECTUM_SOURCE_DIR "/../shared/data/";
  if (!std::ifstream(folder + "laser_dot.avi").good()) {
    MESSAGE("skipped: ", folder, "laser_dot.avi is not there");
    return;
  }
  check_sheet(folder, "foveated sheet", foveated_sheet(480, 360));
  check_sheet(folder, "even grid of 10 px fields", grid_of_fields(32, 24, 960, 720));
}
