#include "tools/report/raster_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "tools/analysis/spike_times.h"

namespace tectum {
namespace {

constexpr double kMinRowPx = 1;
constexpr std::uint16_t kFull = std::numeric_limits<std::uint16_t>::max();

std::uint16_t saturating_sum(std::uint16_t a, std::uint16_t b) {
  return static_cast<std::uint16_t>(std::min<unsigned>(kFull, unsigned{a} + unsigned{b}));
}

/// The count that is drawn darkest.
std::uint16_t dark_count(const RasterGrid& grid) {
  std::vector<std::uint16_t> touched;
  for (const std::uint16_t count : grid.counts) {
    if (count > 0) {
      touched.push_back(count);
    }
  }
  if (touched.empty()) {
    return 1;
  }
  const auto high = touched.begin() + static_cast<std::ptrdiff_t>((touched.size() - 1) * 95 / 100);
  std::nth_element(touched.begin(), high, touched.end());
  return *high;
}

/// 0: nothing to draw; else 1..kDarknessLevels.
std::size_t level_of(std::uint16_t count, std::uint16_t dark) {
  return std::min(kDarknessLevels, (count * kDarknessLevels + dark - 1) / dark);
}

/// Calls `emit(row, begin, end, level)` for each run of touched cells of one level.
template <typename Emit>
void for_each_run(const RasterGrid& grid, Emit emit) {
  const std::uint16_t dark = dark_count(grid);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns;) {
      const std::size_t level = level_of(grid.at(row, column), dark);
      std::size_t end = column + 1;
      while (end < grid.columns && level_of(grid.at(row, end), dark) == level) {
        ++end;
      }
      if (level > 0) {
        emit(row, column, end, level);
      }
      column = end;
    }
  }
}

RasterGrid halved(const RasterGrid& grid, bool halves_rows) {
  RasterGrid half;
  half.spikes = grid.spikes;
  half.rows = halves_rows ? (grid.rows + 1) / 2 : grid.rows;
  half.columns = halves_rows ? grid.columns : (grid.columns + 1) / 2;
  half.counts.resize(half.rows * half.columns);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      std::uint16_t& sum =
          half.counts[(halves_rows ? row / 2 : row) * half.columns + (halves_rows ? column : column / 2)];
      sum = saturating_sum(sum, grid.at(row, column));
    }
  }
  return half;
}

/// One grid's share of a cell each; Needs: shared first.
void settle_cell(std::vector<std::uint16_t>& counts) {
  unsigned total = counts.front();
  std::size_t most = 0;
  for (std::size_t g = 1; g < counts.size(); ++g) {
    total += counts[g];
    most = most == 0 || counts[g] > counts[most] ? g : most;
  }
  const unsigned alone = counts.size() < 2 ? 0 : counts[most];
  const unsigned others = total - counts.front() - alone;
  // Each of the others' spikes takes one of the largest along.
  const unsigned left = alone - std::min(alone, others);
  const std::size_t owner = left > total - left ? most : 0;
  std::fill(counts.begin(), counts.end(), std::uint16_t{0});
  counts[owner] = static_cast<std::uint16_t>(std::min<unsigned>(kFull, total));
}

std::vector<RasterGrid> settled(std::vector<RasterGrid> grids) {
  std::vector<std::uint16_t> counts(grids.size());
  for (std::size_t cell = 0; cell < grids.front().counts.size(); ++cell) {
    for (std::size_t g = 0; g < grids.size(); ++g) {
      counts[g] = grids[g].counts[cell];
    }
    settle_cell(counts);
    for (std::size_t g = 0; g < grids.size(); ++g) {
      grids[g].counts[cell] = counts[g];
    }
  }
  return grids;
}

std::size_t total_runs(const std::vector<RasterGrid>& grids) {
  std::size_t runs = 0;
  for (const RasterGrid& grid : grids) {
    runs += count_runs(grid);
  }
  return runs;
}

bool takes_rows_first(const RasterGrid& grid) {
  // Time is what a raster is read for: rows go first, down to eight.
  return grid.rows > 8 || grid.columns == 1;
}

}  // namespace

std::vector<RasterGrid> raster_grids(const Recording& recording, const LaneLayout& layout, double begin_s, double end_s,
                                     std::size_t columns) {
  std::vector<std::size_t> lane_of_population(recording.populations.size(), layout.lanes.size());
  std::vector<RasterGrid> grids(layout.lanes.size());
  for (std::size_t k = 0; k < layout.lanes.size(); ++k) {
    const std::size_t distinct = static_cast<std::size_t>(std::max(1.0, layout.lanes[k].height_px / kMinRowPx));
    lane_of_population[layout.lanes[k].population] = k;
    grids[k].rows = std::clamp<std::size_t>(recording.populations[layout.lanes[k].population].size, 1, distinct);
    grids[k].columns = columns;
    grids[k].counts.resize(grids[k].rows * columns);
  }
  const std::vector<std::uint32_t> index = population_of_neurons(recording);
  const double columns_per_s = static_cast<double>(columns) / std::max(1e-9, end_s - begin_s);
  SpikeClock clock(recording);
  for (const RecordedSpike& spike : spikes_between(recording, begin_s, end_s)) {
    if (spike.neuron >= index.size() || index[spike.neuron] == kNoPopulation) {
      continue;
    }
    const std::size_t lane = lane_of_population[index[spike.neuron]];
    if (lane == layout.lanes.size()) {
      continue;
    }
    RasterGrid& grid = grids[lane];
    const RecordedPopulation& population = recording.populations[index[spike.neuron]];
    const std::size_t row = std::size_t{spike.neuron - population.first_neuron} * grid.rows / population.size;
    const double at = std::max(0.0, (clock.time_s(spike.tick) - begin_s) * columns_per_s);
    const std::size_t column = std::min(static_cast<std::size_t>(at), columns - 1);
    std::uint16_t& count = grid.counts[row * columns + column];
    count = saturating_sum(count, 1);
    ++grid.spikes;
  }
  return grids;
}

std::size_t count_runs(const RasterGrid& grid) {
  std::size_t runs = 0;
  for_each_run(grid, [&](std::size_t, std::size_t, std::size_t, std::size_t) { ++runs; });
  return runs;
}

std::size_t fair_cap(std::vector<std::size_t> runs, std::size_t budget) {
  std::sort(runs.begin(), runs.end());
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::size_t share = budget / (runs.size() - k);
    if (runs[k] > share) {
      return share;
    }
    budget -= runs[k];
  }
  return runs.empty() ? budget : runs.back();
}

RasterGrid coarsen(RasterGrid grid, std::size_t max_runs) {
  while ((grid.rows > 1 || grid.columns > 1) && count_runs(grid) > max_runs) {
    grid = halved(grid, takes_rows_first(grid));
  }
  return grid;
}

std::size_t count_overlay_runs(const std::vector<RasterGrid>& grids) { return total_runs(settled(grids)); }

std::vector<RasterGrid> coarsen_overlay(std::vector<RasterGrid> grids, std::size_t max_runs) {
  std::vector<RasterGrid> drawn = settled(grids);
  while ((grids.front().rows > 1 || grids.front().columns > 1) && total_runs(drawn) > max_runs) {
    for (RasterGrid& grid : grids) {
      grid = halved(grid, takes_rows_first(grid));
    }
    drawn = settled(grids);
  }
  return drawn;
}

std::array<std::string, kDarknessLevels> raster_paths(const RasterGrid& grid, const Box& box) {
  std::array<std::string, kDarknessLevels> paths;
  const double row_px = box.height / static_cast<double>(grid.rows);
  const double column_px = box.width / static_cast<double>(grid.columns);
  for_each_run(grid, [&](std::size_t row, std::size_t begin, std::size_t end, std::size_t level) {
    fmt::format_to(std::back_inserter(paths[level - 1]), "M{} {}h{}",
                   coordinate(box.x + static_cast<double>(begin) * column_px),
                   coordinate(box.y + (static_cast<double>(row) + 0.5) * row_px),
                   coordinate(static_cast<double>(end - begin) * column_px));
  });
  return paths;
}

}  // namespace tectum
