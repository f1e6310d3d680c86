#include "drivers/head/cluttered_wall.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "drivers/head/noise.h"

namespace tectum {
namespace {

// Finer than any camera here sees it, so that the nearest pixel will do.
constexpr double kPxPerM = 1000;
const cv::Size kSizePx(2400, 1800);

struct Box {
  double left_m, bottom_m, right_m, top_m;
  cv::Scalar bgr;
};

// The window saturates every channel at one side, as in any lit room. No box is as bright in its own channel over the
// other two as the dot is.
const std::vector<Box>& boxes() {
  static const std::vector<Box> kBoxes = {
      {0.42, -0.10, 0.90, 0.60, {255, 255, 255}},   // window
      {-0.22, -0.14, -0.15, -0.09, {40, 150, 45}},  // green
      {0.10, 0.07, 0.16, 0.13, {160, 60, 30}},      // blue
      {-0.12, 0.10, -0.06, 0.14, {20, 140, 160}},   // yellow
      {0.20, -0.20, 0.25, -0.14, {35, 30, 130}},    // dark red
      {-0.60, -0.05, -0.50, 0.20, {120, 120, 120}},
  };
  return kBoxes;
}

cv::Mat paint(double brightness, double blur_sigma_m, std::uint64_t seed) {
  // Cloth: two scales of smoothed noise, a little warmer than grey.
  cv::Mat coarse(kSizePx / 50, CV_32FC1), fine(kSizePx / 6, CV_32FC1), cloth, fine_large;
  head::fill_noise(coarse, brightness * 0.35, seed, head::Stream::WallTexture, 0);
  head::fill_noise(fine, brightness * 0.30, seed, head::Stream::WallTexture, 1);
  cv::resize(coarse, cloth, kSizePx, 0, 0, cv::INTER_CUBIC);
  cv::resize(fine, fine_large, kSizePx, 0, 0, cv::INTER_LINEAR);
  cloth += fine_large;
  cloth += cv::Scalar::all(brightness * 2);
  cv::Mat picture;
  cv::merge(std::vector<cv::Mat>{cloth * 0.9, cloth, cloth * 1.1}, picture);
  picture.convertTo(picture, CV_8UC3);
  const auto x_px = [](double m) { return cvRound(0.5 * kSizePx.width + m * kPxPerM); };
  const auto y_px = [](double m) { return cvRound(0.5 * kSizePx.height - m * kPxPerM); };
  for (const Box& box : boxes()) {
    cv::rectangle(picture, cv::Point(x_px(box.left_m), y_px(box.top_m)),
                  cv::Point(x_px(box.right_m), y_px(box.bottom_m)), box.bgr, cv::FILLED);
  }
  cv::GaussianBlur(picture, picture, cv::Size(0, 0), std::max(0.3, blur_sigma_m * kPxPerM));
  return picture;
}

// Four bytes a pixel to three. Each store's fourth byte is overwritten by the next.
void pack(const std::uint32_t* pixels, std::uint8_t* out, int count) {
  for (int i = 0; i + 1 < count; ++i, out += 3) {
    std::memcpy(out, pixels + i, 4);
  }
  std::memcpy(out, pixels + count - 1, 3);
}

}  // namespace

ClutteredWall::ClutteredWall(double brightness, double blur_sigma_m, std::uint64_t seed)
    : width_px_(kSizePx.width),
      height_px_(kSizePx.height),
      plain_(cv::saturate_cast<std::uint8_t>(brightness * 2) * 0x010101U) {
  const cv::Mat picture = paint(brightness, blur_sigma_m, seed);
  pixels_.reserve(static_cast<std::size_t>(picture.rows) * static_cast<std::size_t>(picture.cols));
  for (int y = 0; y < picture.rows; ++y) {
    const auto* row = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < picture.cols; ++x) {
      pixels_.push_back(row[x][0] | (static_cast<std::uint32_t>(row[x][1]) << 8U) |
                        (static_cast<std::uint32_t>(row[x][2]) << 16U));
    }
  }
}

void ClutteredWall::draw(const Eigen::Matrix3d& picture_to_wall_m, cv::Mat& picture) const {
  Eigen::Matrix3d to_pixels;
  to_pixels << kPxPerM, 0, 0.5 * width_px_, 0, -kPxPerM, 0.5 * height_px_, 0, 0, 1;
  const Eigen::Matrix3d map = to_pixels * picture_to_wall_m;
  // The perspective division is made at both ends of each run of pixels, which are spread evenly between: off by a
  // fifth of a wall pixel at the most oblique view that the joints allow.
  constexpr int kRun = 16;
  constexpr int kFractionBits = 16;
  struct Place {
    std::int32_t u, v;
  };
  const auto place = [](const Eigen::Vector3d& p) {
    constexpr double kOne = 1 << kFractionBits;
    constexpr double kFar = 30000 * kOne;                  // more would not fit
    const double to_place = kOne / std::max(p.z(), 1e-9);  // the wall's horizon and beyond fall far outside
    return Place{static_cast<std::int32_t>(std::clamp(p.x() * to_place, -kFar, kFar)),
                 static_cast<std::int32_t>(std::clamp(p.y() * to_place, -kFar, kFar))};
  };
  const auto inside = [this](Place p) {
    return p.u >= 0 && p.v >= 0 && (p.u >> kFractionBits) < width_px_ && (p.v >> kFractionBits) < height_px_;
  };
  const auto pixel = [this](Place p) {
    return pixels_[static_cast<std::size_t>((p.v >> kFractionBits) * width_px_ + (p.u >> kFractionBits))];
  };
  for (int y = 0; y < picture.rows; ++y) {
    std::uint8_t* out = picture.ptr(y);
    std::array<std::uint32_t, kRun> run;
    Eigen::Vector3d end = map * Eigen::Vector3d(0, y, 1);
    Place next = place(end);
    for (int x0 = 0; x0 < picture.cols; x0 += kRun) {
      Place here = next;
      end += kRun * map.col(0);
      next = place(end);
      const std::int32_t du = next.u / kRun - here.u / kRun;
      const std::int32_t dv = next.v / kRun - here.v / kRun;
      if (inside(here) && inside(next)) {  // then all between are
        for (int i = 0; i < kRun; ++i, here.u += du, here.v += dv) {
          run[static_cast<std::size_t>(i)] = pixel(here);
        }
      } else {
        for (int i = 0; i < kRun; ++i, here.u += du, here.v += dv) {
          run[static_cast<std::size_t>(i)] = inside(here) ? pixel(here) : plain_;
        }
      }
      const int count = std::min(kRun, picture.cols - x0);
      pack(run.data(), out, count);
      out += 3 * count;
    }
  }
}

}  // namespace tectum
