// Where an engineer would say that the laser dot is: the middle of the largest lit blob of a picture.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "drivers/head/kinematics.h"
#include "runtime/image/load_image.h"
#include "runtime/ports/frame.h"

namespace tectum {

class DotFinder {
 public:
  /// A pixel is lit as the image's first retina has it; without a retina, when it is redder by 20 than green or blue.
  DotFinder(const SpikeImage& image, double field_of_view_deg);

  /// Off the optical axis, as error_in_eye() has it. Nothing when no pixel is lit.
  [[nodiscard]] std::optional<Direction> find(const Frame& frame);

 private:
  LitChannel channel_ = LitChannel::RedOverGreenBlue;
  std::uint32_t lit_above_ = 20;
  double field_of_view_deg_;
  std::vector<std::uint8_t> first_of_pixel_;  // see mark_lit_pixels()
  std::vector<std::uint8_t> lit_;
  cv::Mat mask_, labels_, stats_, middles_;
};

}  // namespace tectum
