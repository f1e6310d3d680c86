#include "tools/report/raster_grid.h"

#include <doctest/doctest.h>
#include <algorithm>
#include <array>

#include "tests/report/synthetic_recording.h"
#include "tools/analysis/population_rates.h"

namespace tectum {
namespace {

std::size_t runs(const RasterGrid& grid) {
  std::size_t count = 0;
  for (const std::string& path : raster_paths(grid, {0, 0, 100, 100})) {
    count += static_cast<std::size_t>(std::count(path.begin(), path.end(), 'M'));
  }
  return count;
}

std::size_t sum(const RasterGrid& grid) {
  std::size_t spikes = 0;
  for (const std::uint16_t count : grid.counts) {
    spikes += count;
  }
  return spikes;
}

TEST_CASE("every spike of the window lands in its population's grid, however coarse") {
  const Recording recording = synthetic_recording({4, 2, true});
  const std::vector<PopulationSummary> summaries = population_summaries(recording);
  const LaneLayout layout = lay_out_lanes(recording, summaries, {});
  const std::vector<RasterGrid> grids = raster_grids(recording, layout, 0, 100, 300);
  REQUIRE(grids.size() == layout.lanes.size());
  for (std::size_t k = 0; k < grids.size(); ++k) {
    CAPTURE(recording.populations[layout.lanes[k].population].name);
    CHECK(sum(grids[k]) == summaries[layout.lanes[k].population].spikes);
    const RasterGrid coarse = coarsen(grids[k], 100);
    CHECK(runs(coarse) <= 100);
    CHECK(sum(coarse) == sum(grids[k]));
    CHECK(coarse.spikes == grids[k].spikes);
  }
}

TEST_CASE("a lone spike is one dark mark and neighbours of one darkness are one run") {
  RasterGrid grid{2, 10, std::vector<std::uint16_t>(20, 0), 4};
  grid.counts[3] = grid.counts[4] = grid.counts[5] = 1;
  grid.counts[17] = 1;
  const auto paths = raster_paths(grid, {0, 0, 100, 20});
  CHECK(paths[0].empty());
  CHECK(paths[kDarknessLevels - 1] == "M30 5h30M70 15h10");
}

TEST_CASE("the more spikes on a spot, the darker") {
  RasterGrid grid{1, 4, {1, 2, 3, 4}, 10};
  const auto paths = raster_paths(grid, {0, 0, 4, 1});
  CHECK(paths[1] == "M0 0.5h1");  // 1 of 3: the darkest count is the 95th percentile, which rounds down to 3
  CHECK(paths[3] == "M2 0.5h2");
}

TEST_CASE("what sparse lanes leave of the budget goes to busy ones") {
  CHECK(fair_cap({10, 1000, 2000}, 1010) == 500);
  CHECK(fair_cap({10, 20, 30}, 1000) == 30);
  CHECK(fair_cap({}, 5) == 5);
}

TEST_CASE("a population that never fires is listed and takes no lane") {
  const Recording recording = synthetic_recording({2, 2, true});
  const LaneLayout layout = lay_out_lanes(recording, population_summaries(recording), {});
  REQUIRE(layout.silent.size() == 1);
  CHECK(recording.populations[layout.silent[0]].name == "S.left");
  CHECK(layout.lanes.size() == recording.populations.size() - 1);
}

TEST_CASE("of grids over each other the one with most spikes in a cell is drawn there, and none hides another") {
  // Per cell: shared, of the first alone, of the second alone.
  const std::vector<std::array<std::uint16_t, 3>> cells = {{5, 0, 0}, {0, 3, 0}, {0, 0, 3}, {0, 4, 4},
                                                           {5, 1, 0}, {1, 9, 2}, {0, 2, 9}, {0, 0, 0}};
  const std::vector<std::size_t> owners = {0, 1, 2, 0, 0, 1, 2, 3};
  std::vector<RasterGrid> grids(3, RasterGrid{1, cells.size(), std::vector<std::uint16_t>(cells.size()), 0});
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t g = 0; g < 3; ++g) {
      grids[g].counts[c] = cells[c][g];
    }
  }
  const std::vector<RasterGrid> drawn = coarsen_overlay(grids, 100);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    CAPTURE(c);
    for (std::size_t g = 0; g < 3; ++g) {
      const int all = cells[c][0] + cells[c][1] + cells[c][2];
      CHECK(drawn[g].counts[c] == (g == owners[c] ? all : 0));
    }
  }
}

TEST_CASE("grids over each other are coarsened alike, to so many runs together") {
  std::vector<RasterGrid> grids(3, RasterGrid{16, 64, std::vector<std::uint16_t>(16 * 64), 0});
  for (std::size_t cell = 0; cell < grids[0].counts.size(); ++cell) {
    grids[cell % 3].counts[cell] = 1;
  }
  REQUIRE(count_overlay_runs(grids) > 40);
  const std::vector<RasterGrid> drawn = coarsen_overlay(grids, 40);
  CHECK(count_runs(drawn[0]) + count_runs(drawn[1]) + count_runs(drawn[2]) <= 40);
  CHECK(sum(drawn[0]) + sum(drawn[1]) + sum(drawn[2]) == 16 * 64);
  for (const RasterGrid& grid : drawn) {
    CHECK(grid.rows == drawn[0].rows);
    CHECK(grid.columns == drawn[0].columns);
  }
}

}  // namespace
}  // namespace tectum
