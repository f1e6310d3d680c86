// Order statistics of plain samples. Every function answers 0 for an empty sample.
#pragma once

#include <span>
#include <vector>

namespace tectum {

[[nodiscard]] double mean(std::span<const double> sample);
[[nodiscard]] double root_mean_square(std::span<const double> sample);

/// Linear interpolation between order statistics at (n - 1) * share, share in [0, 1]
/// (Hyndman & Fan 1996, type 7, doi:10.1080/00031305.1996.10473566).
[[nodiscard]] double quantile(std::span<const double> sample, double share);
[[nodiscard]] double median(std::span<const double> sample);

[[nodiscard]] std::vector<double> absolute(std::span<const double> sample);

}  // namespace tectum
