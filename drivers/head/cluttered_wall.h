// A wall with things on it that are not the dot: cloth, a bright window, coloured boxes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace tectum {

class ClutteredWall {
 public:
  ClutteredWall(double brightness, double blur_sigma_m, std::uint64_t seed);

  /// Fills `picture` (CV_8UC3) with the wall through a homography from picture to wall coordinates
  /// (metres right, metres up, 1). Beyond the painted part the wall is plain.
  void draw(const Eigen::Matrix3d& picture_to_wall_m, cv::Mat& picture) const;

 private:
  int width_px_;
  int height_px_;
  std::uint32_t plain_;
  std::vector<std::uint32_t> pixels_;  // blue, green, red from the lowest byte up
};

}  // namespace tectum
