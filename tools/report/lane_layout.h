// Where each population's lane goes. Used by tools/report/lane_plot.cpp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/analysis/population_rates.h"
#include "tools/report/svg.h"

namespace tectum {

struct Lane {
  std::size_t population = 0;
  std::string ink;  // of its nucleus
  double y_px = 0;  // top, from the top of the plot
  double height_px = 0;
};

struct LaneGroup {
  std::string nucleus;
  std::string ink;
  double y_px = 0;  // of its heading
  std::size_t first_lane = 0;
  std::size_t lane_count = 0;
};

struct LaneLayout {
  std::vector<LaneGroup> groups;  // in order of first appearance
  std::vector<Lane> lanes;
  std::vector<std::size_t> silent;  // populations left out
  double lanes_px = 0;              // height without the time axis
};

/// Lanes are as high as their neurons need, up to `max_lane_px`; or all `equal_px` high if that is not 0.
struct LaneHeights {
  double max_lane_px = 64;
  double equal_px = 0;
};

/// `summaries` are the recording's, in its order. Populations that never fire go to `silent`.
[[nodiscard]] LaneLayout lay_out_lanes(const Recording&, const std::vector<PopulationSummary>& summaries, LaneHeights);

/// Left margin that fits the lanes' names into a third of the width.
[[nodiscard]] double lane_label_px(const Recording&, const LaneLayout&, double width_px);

/// Headings, names, separators, time axis. `plot` is the part right of the names.
void draw_lane_frame(SvgBody&, const Recording&, const LaneLayout&, const Box& plot, double left_px, double begin_s,
                     double end_s);

inline constexpr double kLaneAxisPx = 36;
inline constexpr double kLaneHeadingPx = 17;
inline constexpr double kSilentLinePx = 16;

}  // namespace tectum
