#include "drivers/head/eye_camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "drivers/head/philox.h"

namespace tectum {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr int kEdgeStepsPerPx = 64;
constexpr double kEdgeSigmas = 4;        // the blurred rim is followed this far to either side
constexpr double kSharpestBlurPx = 0.3;  // a pixel's own aperture, about 1/sqrt(12)
// The noise picture is larger than the frame by this much each way; a frame takes a window at a drawn offset.
constexpr int kNoiseSlackPx = 64;

// Pairs of normal deviates, Box & Muller 1958.
void fill_noise(cv::Mat& noise, double sigma, std::uint64_t seed, std::uint32_t camera) {
  std::uint64_t index = 0;
  for (int y = 0; y < noise.rows; ++y) {
    float* row = noise.ptr<float>(y);
    for (int x = 0; x < noise.cols * noise.channels(); x += 2) {
      const auto words = head::draw(seed, head::Stream::NoiseTile, index++, camera);
      const double radius = sigma * std::sqrt(-2 * std::log(head::unit_interval(words[0])));
      const double angle = 2 * std::numbers::pi * head::unit_interval(words[1]);
      row[x] = static_cast<float>(radius * std::cos(angle));
      if (x + 1 < noise.cols * noise.channels()) {
        row[x + 1] = static_cast<float>(radius * std::sin(angle));
      }
    }
  }
}

void paint_box(cv::Mat& picture, double px_per_m, double left_m, double bottom_m, double right_m, double top_m,
               const cv::Scalar& bgr) {
  const double middle_x = picture.cols / 2.0;
  const double middle_y = picture.rows / 2.0;
  cv::rectangle(picture, cv::Point(cvRound(middle_x + left_m * px_per_m), cvRound(middle_y - top_m * px_per_m)),
                cv::Point(cvRound(middle_x + right_m * px_per_m), cvRound(middle_y - bottom_m * px_per_m)), bgr,
                cv::FILLED);
}

}  // namespace

std::shared_ptr<const WallTexture> make_cluttered_wall(const EyeCameraParams& params) {
  auto wall = std::make_shared<WallTexture>();
  wall->px_per_m = 500;
  const cv::Size size_px(1500, 1200);  // 3.0 m x 2.4 m
  // Cloth: two scales of smoothed noise, each channel nearly the same.
  cv::Mat coarse(size_px / 25, CV_32FC1), fine(size_px / 3, CV_32FC1), coarse_large, fine_large;
  fill_noise(coarse, params.wall_brightness * 0.35, params.seed, 100);
  fill_noise(fine, params.wall_brightness * 0.30, params.seed, 101);
  cv::resize(coarse, coarse_large, size_px, 0, 0, cv::INTER_CUBIC);
  cv::resize(fine, fine_large, size_px, 0, 0, cv::INTER_LINEAR);
  cv::Mat cloth, warm, cold;
  cv::Mat(coarse_large + fine_large + params.wall_brightness * 2).convertTo(cloth, CV_8UC1);
  cv::Mat(cloth * 1.1).convertTo(warm, CV_8UC1);
  cv::Mat(cloth * 0.9).convertTo(cold, CV_8UC1);
  cv::merge(std::vector<cv::Mat>{cold, cloth, warm}, wall->bgr);
  // A window saturates every channel at one side, as in any lit room; boxes in plain colours, none of them as bright
  // in its own channel over the others as the dot.
  const double scale = wall->px_per_m;
  paint_box(wall->bgr, scale, 0.42, -0.10, 0.90, 0.60, {255, 255, 255});
  paint_box(wall->bgr, scale, -0.22, -0.14, -0.15, -0.09, {40, 150, 45});   // green
  paint_box(wall->bgr, scale, 0.10, 0.07, 0.16, 0.13, {160, 60, 30});       // blue
  paint_box(wall->bgr, scale, -0.12, 0.10, -0.06, 0.14, {20, 140, 160});    // yellow
  paint_box(wall->bgr, scale, 0.20, -0.20, 0.25, -0.14, {35, 30, 130});     // dark red
  paint_box(wall->bgr, scale, -0.60, -0.05, -0.50, 0.20, {120, 120, 120});  // grey
  cv::GaussianBlur(wall->bgr, wall->bgr, cv::Size(0, 0), std::max(0.3, params.blur_sigma_px * 0.6));
  return wall;
}

EyeCamera::EyeCamera(const EyeCameraParams& params, const HeadGeometry& geometry, std::uint32_t camera,
                     std::shared_ptr<const WallTexture> wall)
    : params_(params),
      geometry_(geometry),
      camera_(camera),
      focal_px_(0.5 * params.width_px / std::tan(0.5 * params.field_of_view_deg * kRadPerDeg)),
      centre_{0.5 * (params.width_px - 1), 0.5 * (params.height_px - 1)},
      wall_(std::move(wall)) {
  if (params_.clutter && !wall_) {
    wall_ = make_cluttered_wall(params_);
  }
  const cv::Scalar grey = cv::Scalar::all(params_.wall_brightness);
  picture_ = cv::Mat(params_.height_px, params_.width_px, CV_8UC3, grey);
  if (params_.noise_sigma > 0) {
    cv::Mat noise(params_.height_px + kNoiseSlackPx, params_.width_px + kNoiseSlackPx, CV_32FC3);
    fill_noise(noise, params_.noise_sigma, params_.seed, camera_);
    if (wall_) {
      noise.convertTo(brighter_, CV_8UC3);  // saturates: negative becomes 0
      noise.convertTo(darker_, CV_8UC3, -1);
    } else {
      cv::Mat(noise + grey).convertTo(noisy_wall_, CV_8UC3);
    }
  }
  // A disc blurred by a Gaussian, along the radius: brightness * Phi(-d / sigma) at distance d outside the rim. Right
  // for a disc that is not much smaller than the blur.
  const double sigma_px = std::max(params_.blur_sigma_px, kSharpestBlurPx);
  const int steps = static_cast<int>(2 * kEdgeSigmas * sigma_px * kEdgeStepsPerPx) + 2;
  edge_.resize(static_cast<std::size_t>(steps));
  for (int i = 0; i < steps; ++i) {
    const double past_rim_px = static_cast<double>(i) / kEdgeStepsPerPx - kEdgeSigmas * sigma_px;
    edge_[static_cast<std::size_t>(i)] =
        static_cast<float>(params_.dot_brightness * 0.5 * std::erfc(past_rim_px / (std::numbers::sqrt2 * sigma_px)));
  }
}

bool EyeCamera::project(const EyePose& pose, const Eigen::Vector3d& point_m, PixelPoint& out) const {
  const Eigen::Vector3d in_eye = pose.axes.transpose() * (point_m - pose.position_m);
  if (in_eye.z() < 1e-3) {
    return false;
  }
  out = {centre_.x + focal_px_ * in_eye.x() / in_eye.z(), centre_.y - focal_px_ * in_eye.y() / in_eye.z()};
  return true;
}

void EyeCamera::draw_background(const EyePose& pose, std::uint64_t sequence) {
  cv::Rect window(0, 0, picture_.cols, picture_.rows);
  if (params_.noise_sigma > 0) {
    const auto words = head::draw(params_.seed, head::Stream::SensorNoise, sequence, camera_);
    window.x = static_cast<int>(words[0] % kNoiseSlackPx);
    window.y = static_cast<int>(words[1] % kNoiseSlackPx);
  }
  if (!wall_) {
    if (params_.noise_sigma > 0) {
      noisy_wall_(window).copyTo(picture_);
    } else {
      picture_(dirty_).setTo(cv::Scalar::all(params_.wall_brightness));
    }
    return;
  }
  // Homography from the wall's picture to the camera's: a wall picture's pixel (a, b) lies at
  // ((a - middle) / scale, -(b - middle) / scale, wall) in the head-base frame.
  const double scale = wall_->px_per_m;
  Eigen::Matrix3d to_base;
  to_base << 1 / scale, 0, -0.5 * (wall_->bgr.cols - 1) / scale, 0, -1 / scale, 0.5 * (wall_->bgr.rows - 1) / scale, 0,
      0, geometry_.wall_distance_m;
  to_base.col(2) -= pose.position_m;
  Eigen::Matrix3d camera;
  camera << focal_px_, 0, centre_.x, 0, -focal_px_, centre_.y, 0, 0, 1;
  const Eigen::Matrix3d to_wall = (camera * pose.axes.transpose() * to_base).inverse();
  cv::Matx33d homography;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      homography(row, column) = to_wall(row, column);
    }
  }
  cv::warpPerspective(wall_->bgr, picture_, homography, picture_.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                      cv::BORDER_CONSTANT, cv::Scalar::all(params_.wall_brightness));
  if (params_.noise_sigma > 0) {
    cv::add(picture_, brighter_(window), picture_);
    cv::subtract(picture_, darker_(window), picture_);
  }
}

void EyeCamera::draw_dot(const EyePose& pose, const WallPoint& dot_m) {
  dirty_ = {};
  const Eigen::Vector3d on_wall = wall_to_base(geometry_, dot_m);
  PixelPoint middle;
  if (!project(pose, on_wall, middle)) {
    return;
  }
  // How the picture's point moves with the wall's, px/m: the disc on the wall becomes an ellipse.
  const Eigen::Vector3d q = pose.axes.transpose() * (on_wall - pose.position_m);
  const double k = focal_px_ / (q.z() * q.z());
  Eigen::Matrix2d jacobian;
  for (int column = 0; column < 2; ++column) {
    const Eigen::Vector3d d = pose.axes.transpose().col(column);  // of wall right, wall up, in the eye's frame
    jacobian(0, column) = k * (d.x() * q.z() - q.x() * d.z());
    jacobian(1, column) = -k * (d.y() * q.z() - q.y() * d.z());
  }
  const double px_per_m = std::sqrt(std::abs(jacobian.determinant()));
  if (!(px_per_m > 1e-6)) {
    return;
  }
  // Distance on the wall, in the picture's mean scale.
  const Eigen::Matrix2d to_round = jacobian.inverse() * px_per_m;
  const double radius_px = params_.dot_radius_m * px_per_m;
  const double sigma_px = std::max(params_.blur_sigma_px, kSharpestBlurPx);
  const double first_px = radius_px - kEdgeSigmas * sigma_px;
  const double reach_px = (radius_px + kEdgeSigmas * sigma_px) * jacobian.norm() / px_per_m;

  const int x0 = std::max(0, static_cast<int>(std::floor(middle.x - reach_px)));
  const int x1 = std::min(picture_.cols, static_cast<int>(std::ceil(middle.x + reach_px)) + 1);
  const int y0 = std::max(0, static_cast<int>(std::floor(middle.y - reach_px)));
  const int y1 = std::min(picture_.rows, static_cast<int>(std::ceil(middle.y + reach_px)) + 1);
  if (middle.x + reach_px < 0 || middle.y + reach_px < 0 || x0 >= x1 || y0 >= y1) {
    return;
  }
  dirty_ = cv::Rect(x0, y0, x1 - x0, y1 - y0);
  const int channel = params_.dot_colour == DotColour::Red ? 2 : params_.dot_colour == DotColour::Green ? 1 : 0;
  for (int y = y0; y < y1; ++y) {
    auto* row = picture_.ptr<cv::Vec3b>(y);
    for (int x = x0; x < x1; ++x) {
      const Eigen::Vector2d offset = to_round * Eigen::Vector2d(x - middle.x, y - middle.y);
      const double past_px = std::max(0.0, offset.norm() - first_px);
      const auto step = static_cast<std::size_t>(past_px * kEdgeStepsPerPx + 0.5);
      if (step >= edge_.size()) {
        continue;
      }
      const float light = edge_[step];
      for (int c = 0; c < 3; ++c) {
        const double share = c == channel ? 1.0 : params_.dot_bleed;
        row[x][c] = cv::saturate_cast<std::uint8_t>(row[x][c] + light * share);
      }
    }
  }
}

const cv::Mat& EyeCamera::render(const EyePose& pose, const WallPoint& dot_m, std::uint64_t sequence) {
  draw_background(pose, sequence);
  draw_dot(pose, dot_m);
  return picture_;
}

}  // namespace tectum
