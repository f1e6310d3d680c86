// Spikes counted on a grid of neuron rows by time columns, and drawn as runs of equal darkness.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/report/lane_layout.h"
#include "tools/report/svg.h"

namespace tectum {

struct RasterGrid {
  std::size_t rows = 1;
  std::size_t columns = 1;
  std::vector<std::uint16_t> counts;  // [row * columns + column], saturating
  std::size_t spikes = 0;

  [[nodiscard]] std::uint16_t at(std::size_t row, std::size_t column) const { return counts[row * columns + column]; }
};

/// One grid a lane. Spikes in [begin_s, end_s); a lane has no more rows than can be told apart.
[[nodiscard]] std::vector<RasterGrid> raster_grids(const Recording&, const LaneLayout&, double begin_s, double end_s,
                                                   std::size_t columns);

[[nodiscard]] std::size_t count_runs(const RasterGrid&);

/// The largest cap for which sum(min(runs, cap)) stays within the budget: what sparse lanes do not need goes to busy
/// ones.
[[nodiscard]] std::size_t fair_cap(std::vector<std::size_t> runs, std::size_t budget);

/// Halves the resolution, rows or columns, whichever has more, until the grid draws in at most `max_runs` runs.
[[nodiscard]] RasterGrid coarsen(RasterGrid grid, std::size_t max_runs);

/// For grids of one lane that are drawn over each other, the first of what the others share, so that none hides
/// another: within a cell a spike of one and a spike of the other are taken for one that they share, a little apart,
/// and then the cell belongs to the grid with most spikes in it. All are coarsened alike, to at most `max_runs` runs
/// together.
[[nodiscard]] std::vector<RasterGrid> coarsen_overlay(std::vector<RasterGrid> grids, std::size_t max_runs);
[[nodiscard]] std::size_t count_overlay_runs(const std::vector<RasterGrid>& grids);

inline constexpr std::size_t kDarknessLevels = 4;

/// Path commands, one path a level of darkness (the last is the darkest): horizontal strokes that fill the box.
/// The level of a cell is its count's share of the grid's 95th percentile of touched cells.
[[nodiscard]] std::array<std::string, kDarknessLevels> raster_paths(const RasterGrid&, const Box&);

}  // namespace tectum
