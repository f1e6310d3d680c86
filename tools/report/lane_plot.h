// Populations as lanes over a common time axis, grouped by nucleus: spike rasters and firing rates.
#pragma once

#include <string>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/report/svg.h"

namespace tectum {

struct LaneWindow {
  double begin_s = 0;
  double end_s = 0;
};

struct LanePlotOptions {
  LaneWindow window;
  /// Populations that never fire in the whole recording become one line of text instead of empty lanes.
  bool omits_silent = true;
  /// At most this many drawn runs of spikes; beyond it neighbouring time columns are merged, coarser and coarser.
  std::size_t max_runs = 40'000;
  std::vector<double> marks_s;  // thin vertical lines
  std::vector<LaneWindow> shades;
};

/// Every spike as a tick mark in its neuron's row; the population's mean rate over the window at the side, as a
/// number and a bar.
class RasterPlot {
 public:
  RasterPlot(const Recording&, LanePlotOptions);
  [[nodiscard]] double height_px() const;
  void draw(SvgBody&, const Box&) const;  // box.height is ignored: height_px() says
  [[nodiscard]] std::string responsive(const std::string& description) const;

 private:
  const Recording& recording_;
  LanePlotOptions options_;
};

/// Each population's rate (bins of 20 ms) as a filled curve on a scale of its own, whose top is at the side.
class RatePlot {
 public:
  RatePlot(const Recording&, LanePlotOptions);
  [[nodiscard]] double height_px() const;
  void draw(SvgBody&, const Box&) const;
  [[nodiscard]] std::string responsive(const std::string& description) const;

 private:
  const Recording& recording_;
  LanePlotOptions options_;
};

}  // namespace tectum
