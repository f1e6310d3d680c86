#include "drivers/head/eye_camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/head/noise.h"

namespace tectum {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr int kEdgeStepsPerPx = 64;
constexpr double kEdgeSigmas = 4;        // the blurred rim is followed this far to either side
constexpr double kSharpestBlurPx = 0.3;  // a pixel's own aperture, about 1/sqrt(12)
// The noise picture is larger than the frame by this much each way; a frame takes a window at a drawn offset.
constexpr int kNoiseSlackPx = 64;

}  // namespace

std::shared_ptr<const ClutteredWall> make_cluttered_wall(const EyeCameraParams& params) {
  // The lens's blur, in metres on the wall at half a metre.
  const double px_per_m = 0.5 * params.width_px / std::tan(0.5 * params.field_of_view_deg * kRadPerDeg) / 0.5;
  return std::make_shared<ClutteredWall>(params.wall_brightness, params.blur_sigma_px / px_per_m, params.seed);
}

EyeCamera::EyeCamera(const EyeCameraParams& params, const HeadGeometry& geometry, std::uint32_t camera,
                     std::shared_ptr<const ClutteredWall> wall)
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
    head::fill_noise(noise, params_.noise_sigma, params_.seed, head::Stream::NoiseTile, camera_);
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
  // A wall point (right, up) lies at (right, up, wall) in the head-base frame.
  Eigen::Matrix3d to_base;
  to_base << 1, 0, 0, 0, 1, 0, 0, 0, geometry_.wall_distance_m;
  to_base.col(2) -= pose.position_m;
  Eigen::Matrix3d camera;
  camera << focal_px_, 0, centre_.x, 0, -focal_px_, centre_.y, 0, 0, 1;
  wall_->draw((camera * pose.axes.transpose() * to_base).inverse(), picture_);
  if (params_.noise_sigma > 0) {
    cv::add(picture_, brighter_(window), picture_);
    cv::subtract(picture_, darker_(window), picture_);
  }
}

void EyeCamera::draw_dot(const EyePose& pose, const Eigen::Vector3d& dot_m) {
  dirty_ = {};
  PixelPoint middle;
  if (!project(pose, dot_m, middle)) {
    return;
  }
  // How the picture's point moves with the wall's, px/m: the disc on the wall becomes an ellipse.
  const Eigen::Vector3d q = pose.axes.transpose() * (dot_m - pose.position_m);
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
  return render_in_depth(pose, wall_to_base(geometry_, dot_m), sequence);
}

const cv::Mat& EyeCamera::render_in_depth(const EyePose& pose, const Eigen::Vector3d& dot_m, std::uint64_t sequence) {
  draw_background(pose, sequence);
  draw_dot(pose, dot_m);
  return picture_;
}

}  // namespace tectum
