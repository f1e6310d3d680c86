// A pinhole camera that draws what an eye sees: a wall and a laser dot on it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "drivers/head/cluttered_wall.h"
#include "drivers/head/kinematics.h"

namespace tectum {

enum class DotColour : std::uint8_t { Red, Green, Blue };

struct EyeCameraParams {
  int width_px = 320;
  int height_px = 320;
  /// Horizontal. The default is the middle 720 pixels of a 1280-pixel camera with 65 deg, the view of the published
  /// controllers; the retina of the circuit has to say the same.
  double field_of_view_deg = 39.4;

  DotColour dot_colour = DotColour::Red;
  /// On the wall, so that it grows as the eye comes nearer: 4 px in the controllers' 720-pixel view at 0.55 m.
  double dot_radius_m = 0.0022;
  /// Of the dot's channel over the wall's; above 255 it saturates, as a laser does in a short exposure.
  double dot_brightness = 300;
  /// Share of it that leaks into the other two channels.
  double dot_bleed = 0.15;
  double blur_sigma_px = 0.8;   // lens and demosaicing
  double noise_sigma = 0;       // of the sensor, in grey levels of 255, each channel on its own
  double wall_brightness = 12;  // a dim room at the short exposure that a laser asks for
  /// Texture, a bright window and coloured boxes on the wall: things that are not the dot.
  bool clutter = false;

  std::uint64_t seed = 1;
};

/// Pixel coordinates: the centre of the top left pixel is (0, 0), y down.
struct PixelPoint {
  double x = 0;
  double y = 0;
};

/// Painted once and shared by both eyes.
[[nodiscard]] std::shared_ptr<const ClutteredWall> make_cluttered_wall(const EyeCameraParams& params);

class EyeCamera {
 public:
  /// `camera` keeps the noise of the cameras of one seed apart. Allocates everything that drawing needs.
  EyeCamera(const EyeCameraParams& params, const HeadGeometry& geometry, std::uint32_t camera,
            std::shared_ptr<const ClutteredWall> wall = nullptr);

  /// The picture for a pose; noise depends on `sequence` alone. It stays until the next call.
  const cv::Mat& render(const EyePose& pose, const WallPoint& dot_m, std::uint64_t sequence);
  /// With the dot on a screen before the wall, parallel to it: a point of the head-base frame.
  const cv::Mat& render_in_depth(const EyePose& pose, const Eigen::Vector3d& dot_m, std::uint64_t sequence);

  /// Where a point of the head-base frame falls in the picture. False when it lies behind the camera.
  [[nodiscard]] bool project(const EyePose& pose, const Eigen::Vector3d& point_m, PixelPoint& out) const;
  [[nodiscard]] double focal_px() const { return focal_px_; }

 private:
  void draw_background(const EyePose& pose, std::uint64_t sequence);
  void draw_dot(const EyePose& pose, const Eigen::Vector3d& dot_m);

  EyeCameraParams params_;
  HeadGeometry geometry_;
  std::uint32_t camera_;
  double focal_px_;
  PixelPoint centre_;
  std::shared_ptr<const ClutteredWall> wall_;
  cv::Mat picture_;
  cv::Rect dirty_;             // what the last dot changed on a plain wall
  cv::Mat noisy_wall_;         // plain wall with noise, larger than the picture
  cv::Mat brighter_, darker_;  // the noise alone, for the cluttered wall
  std::vector<float> edge_;    // dot's brightness by distance past its rim, see kEdgeStepsPerPx
};

}  // namespace tectum
