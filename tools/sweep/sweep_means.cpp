#include "tools/sweep/sweep_means.h"

#include <map>

namespace tectum {

std::vector<MeanOverRest> means_over_rest(const SweepPlan& plan, const SweepResult& result,
                                          const std::vector<std::size_t>& axes_in_view, std::size_t measure) {
  std::map<SweepPoint, MeanOverRest> found;
  for (std::size_t k = 0; k < result.points.size(); ++k) {
    const std::optional<double>& value = result.rows[k][measure];
    if (!value) {
      continue;
    }
    SweepPoint in_view(plan.axes.size(), 0);
    for (const std::size_t a : axes_in_view) {
      in_view[a] = result.points[k][a];
    }
    MeanOverRest& mean = found[in_view];
    mean.point = in_view;
    mean.mean += *value;
    ++mean.count;
  }
  std::vector<MeanOverRest> means;
  for (auto& [point, mean] : found) {
    mean.mean /= static_cast<double>(mean.count);
    means.push_back(mean);
  }
  return means;
}

}  // namespace tectum
