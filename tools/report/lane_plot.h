// Populations as lanes over a common time axis, grouped by nucleus: spike rasters and firing rates.
#pragma once

#include <string>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/analysis/population_rates.h"
#include "tools/report/svg.h"

namespace tectum {

struct LaneWindow {
  double begin_s = 0;
  double end_s = 0;
};

struct LanePlotOptions {
  LaneWindow window;
  double max_lane_px = 64;
  /// About this many drawn runs of spikes at most: lanes too busy for their part of it are drawn coarser.
  std::size_t max_runs = 40'000;
  std::vector<double> marks_s;  // thin vertical lines
  std::vector<LaneWindow> shades;
};

/// Every spike as a mark in its neuron's row; where several fall on one spot, the more the darker. The population's
/// mean rate over the window stands at the side, as a number and a bar. Populations that never fired in the whole
/// recording are listed below.
class RasterPlot {
 public:
  /// `summaries` are population_summaries(recording); both must outlive the plot.
  RasterPlot(const Recording& recording, const std::vector<PopulationSummary>& summaries, LanePlotOptions);
  [[nodiscard]] double height_px() const;
  void draw(SvgBody&, const Box&) const;  // box.height is ignored: height_px() says
  [[nodiscard]] std::string responsive(const std::string& description) const;

 private:
  const Recording& recording_;
  const std::vector<PopulationSummary>& summaries_;
  LanePlotOptions options_;
};

/// Each population's rate (bins of 20 ms) as a filled curve on a scale of its own, whose top is at the side.
class RatePlot {
 public:
  RatePlot(const Recording& recording, const std::vector<PopulationSummary>& summaries, LanePlotOptions);
  [[nodiscard]] double height_px() const;
  void draw(SvgBody&, const Box&) const;
  [[nodiscard]] std::string responsive(const std::string& description) const;

 private:
  const Recording& recording_;
  const std::vector<PopulationSummary>& summaries_;
  LanePlotOptions options_;
};

/// One of several rasters in one picture.
struct OverlayRaster {
  const Recording* recording = nullptr;  // same populations and neurons in all
  std::string ink;                       // a role of tools/report/theme.h
};

/// Rasters over each other, each in its own ink, the first of what the others share; a place has the ink of most spikes
/// there (tools/report/raster_grid.h). `summaries` are of all their spikes together, and must outlive the plot.
class OverlayPlot {
 public:
  OverlayPlot(std::vector<OverlayRaster> rasters, const std::vector<PopulationSummary>& summaries,
              LanePlotOptions options);
  [[nodiscard]] double height_px() const;
  void draw(SvgBody&, const Box&) const;
  [[nodiscard]] std::string responsive(const std::string& description) const;

 private:
  std::vector<OverlayRaster> rasters_;
  const std::vector<PopulationSummary>& summaries_;
  LanePlotOptions options_;
};

}  // namespace tectum
