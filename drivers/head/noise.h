// Normal noise in a picture, the same for the same seed.
#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "drivers/head/random_streams.h"

namespace tectum::head {

/// Fills a float picture. Pairs of deviates: Box & Muller 1958, doi:10.1214/aoms/1177706645.
inline void fill_noise(cv::Mat& noise, double sigma, std::uint64_t seed, Stream stream, std::uint32_t part) {
  std::uint64_t index = 0;
  for (int y = 0; y < noise.rows; ++y) {
    float* row = noise.ptr<float>(y);
    const int count = noise.cols * noise.channels();
    for (int x = 0; x < count; x += 2) {
      const auto words = draw(seed, stream, index++, part);
      const double radius = sigma * std::sqrt(-2 * std::log(unit_interval(words[0])));
      const double angle = 2 * std::numbers::pi * unit_interval(words[1]);
      row[x] = static_cast<float>(radius * std::cos(angle));
      if (x + 1 < count) {
        row[x + 1] = static_cast<float>(radius * std::sin(angle));
      }
    }
  }
}

}  // namespace tectum::head
