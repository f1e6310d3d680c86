#include "tools/analysis/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tectum {

double mean(std::span<const double> sample) {
  if (sample.empty()) {
    return 0;
  }
  double sum = 0;
  for (const double value : sample) {
    sum += value;
  }
  return sum / static_cast<double>(sample.size());
}

double root_mean_square(std::span<const double> sample) {
  if (sample.empty()) {
    return 0;
  }
  double sum = 0;
  for (const double value : sample) {
    sum += value * value;
  }
  return std::sqrt(sum / static_cast<double>(sample.size()));
}

double quantile(std::span<const double> sample, double share) {
  if (sample.empty()) {
    return 0;
  }
  std::vector<double> sorted(sample.begin(), sample.end());
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::clamp(share, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (rank - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double median(std::span<const double> sample) { return quantile(sample, 0.5); }

std::vector<double> absolute(std::span<const double> sample) {
  std::vector<double> magnitudes;
  magnitudes.reserve(sample.size());
  for (const double value : sample) {
    magnitudes.push_back(std::abs(value));
  }
  return magnitudes;
}

}  // namespace tectum
