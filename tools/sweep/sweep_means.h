// Means of a measure over the axes that are left out of view.
#pragma once

#include <array>
#include <vector>

#include "tools/sweep/sweep.h"

namespace tectum {

/// Of kSweepMeasures: those that people want first. RMS error, jitter, latency, overshoot.
inline constexpr std::array<std::size_t, 4> kMainMeasures = {0, 5, 6, 7};

struct MeanOverRest {
  SweepPoint point;  // on the axes in view; 0 on the others
  double mean = 0;
  std::size_t count = 0;
};

/// In the order of the points; a place where nothing was measured is left out.
[[nodiscard]] std::vector<MeanOverRest> means_over_rest(const SweepPlan& plan, const SweepResult& result,
                                                        const std::vector<std::size_t>& axes_in_view,
                                                        std::size_t measure);

}  // namespace tectum
