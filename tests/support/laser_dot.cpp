#include "tests/support/laser_dot.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace tectum {
namespace {

constexpr float kDotDiscRadiusPx = 6;

/// Squared distance from a point to a rectangle.
float distance2(const FieldRecord& f, float x, float y) {
  const float dx = std::max({f.x0 - x, x - f.x1, 0.0F}), dy = std::max({f.y0 - y, y - f.y1, 0.0F});
  return dx * dx + dy * dy;
}

}  // namespace

std::string laser_dot_folder() {
  const std::string folder = TECTUM_SOURCE_DIR "/../shared/data/";
  return std::ifstream(folder + "laser_dot.avi").good() ? folder : "";
}

std::vector<DotTruth> read_dot_truth(const std::string& path) {
  std::ifstream file(path);
  std::vector<DotTruth> truths;
  std::string line;
  std::getline(file, line);  // frame,x_px,y_px,dot_visible,at_image_edge,green_box_drawn
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<std::string> cell;
    for (std::string text; std::getline(cells, text, ',');) {
      cell.push_back(text);
    }
    REQUIRE(cell.size() == 6);
    DotTruth truth{.is_visible = cell[3] == "1", .has_drawn_box = cell[5].starts_with('1')};
    if (truth.is_visible) {
      truth.x_px = std::stof(cell[1]);
      truth.y_px = std::stof(cell[2]);
    }
    truths.push_back(truth);
  }
  return truths;
}

void DotScore::add(const DotTruth& truth, std::span<const std::uint32_t> active, std::span<const FieldRecord> fields,
                   const CameraToReference& map) {
  if (!truth.is_visible) {
    ++off;
    silent += active.empty() ? 1 : 0;
    return;
  }
  // Pixel 0's centre lies at 0.5 of the half-open frame.
  const float x = (truth.x_px + 0.5F - map.crop_left_px) * map.reference_per_camera_px;
  const float y = (truth.y_px + 0.5F - map.crop_top_px) * map.reference_per_camera_px;
  const float radius = kDotDiscRadiusPx * map.reference_per_camera_px;
  bool is_contained = false, is_away = false;
  for (const std::uint32_t k : active) {
    const FieldRecord& f = fields[k];
    is_contained = is_contained || (x >= f.x0 && x < f.x1 && y >= f.y0 && y < f.y1);
    is_away = is_away || distance2(f, x, y) > radius * radius;
  }
  ++visible;
  contained += is_contained ? 1 : 0;
  nothing_away += is_away ? 0 : 1;
  both += is_contained && !is_away ? 1 : 0;
}

std::string DotScore::text() const {
  std::ostringstream out;
  out << both << " of " << visible << " visible dots seen and nothing else (contained " << contained
      << ", nothing away " << nothing_away << "); silent in " << silent << " of " << off << " frames without a dot";
  return out.str();
}

}  // namespace tectum
