#include "tools/evaluate/dot_finder.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "runtime/sense/lit_pixels.h"

namespace tectum {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;
constexpr int kNeighbours = 8;

}  // namespace

DotFinder::DotFinder(const SpikeImage& image, double field_of_view_deg) : field_of_view_deg_(field_of_view_deg) {
  if (!image.retinas.empty()) {
    channel_ = image.retinas.front().lit_channel;
    lit_above_ = image.retinas.front().lit_above;
  }
}

std::optional<Direction> DotFinder::find(const Frame& frame) {
  const auto width = static_cast<std::size_t>(frame.width_px);
  first_of_pixel_.assign(3 * width, 0);
  for (std::size_t x = 0; x < width; ++x) {
    first_of_pixel_[3 * x] = 1;
  }
  lit_.resize(3 * width);
  mask_.create(frame.height_px, frame.width_px, CV_8UC1);
  bool is_any_lit = false;
  for (int y = 0; y < frame.height_px; ++y) {
    const std::uint8_t* row = frame.bgr + static_cast<std::size_t>(y) * frame.stride_bytes;
    const bool is_lit = mark_lit_pixels(channel_, lit_above_, row, width, first_of_pixel_.data(), lit_.data());
    std::uint8_t* mask = mask_.ptr<std::uint8_t>(y);
    for (std::size_t x = 0; x < width; ++x) {
      mask[x] = is_lit ? lit_[3 * x] : 0;
    }
    is_any_lit = is_any_lit || is_lit;
  }
  if (!is_any_lit) {
    return std::nullopt;
  }
  const int labels = cv::connectedComponentsWithStats(mask_, labels_, stats_, middles_, kNeighbours, CV_32S);
  int largest = 1;  // 0 is what is not lit
  for (int label = 2; label < labels; ++label) {
    if (stats_.at<int>(label, cv::CC_STAT_AREA) > stats_.at<int>(largest, cv::CC_STAT_AREA)) {
      largest = label;
    }
  }
  const double focal_px = 0.5 * frame.width_px / std::tan(0.5 * field_of_view_deg_ / kDegPerRad);
  const double right = (middles_.at<double>(largest, 0) - 0.5 * (frame.width_px - 1)) / focal_px;
  const double up = (0.5 * (frame.height_px - 1) - middles_.at<double>(largest, 1)) / focal_px;
  return direction_of({right, up, 1});
}

}  // namespace tectum
