#include "tools/report/lane_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "tools/report/chart.h"
#include "tools/report/lane_layout.h"
#include "tools/report/raster_grid.h"

namespace tectum {
namespace {

constexpr double kRateBinS = 0.02;
constexpr double kRateLanePx = 24;
constexpr double kSidePx = 52;  // "1234 Hz"
constexpr double kBarPx = 46;   // room for the bars on wide pictures
constexpr double kWideFromPx = 600;
constexpr std::array<const char*, kDarknessLevels> kDarkness = {"0.3", "0.5", "0.75", "1"};

double plot_height_px(const LaneLayout& layout) {
  return layout.lanes_px + kLaneAxisPx + (layout.silent.empty() ? 0 : kSilentLinePx);
}

Box plot_box(const Recording& recording, const LaneLayout& layout, const Box& box) {
  const double left = lane_label_px(recording, layout, box.width);
  const double side = kSidePx + (box.width >= kWideFromPx ? kBarPx : 0);
  return {box.x + left, box.y, std::max(20.0, box.width - left - side), layout.lanes_px};
}

void draw_marks(SvgBody& svg, const LanePlotOptions& options, const Box& plot) {
  const double span_s = std::max(1e-9, options.window.end_s - options.window.begin_s);
  const auto px = [&](double time_s) { return plot.x + (time_s - options.window.begin_s) / span_s * plot.width; };
  for (const LaneWindow& shade : options.shades) {
    svg.rect({px(shade.begin_s), plot.y, px(shade.end_s) - px(shade.begin_s), plot.height}, "f-muted", 0.14);
  }
  for (const double mark_s : options.marks_s) {
    if (mark_s >= options.window.begin_s && mark_s < options.window.end_s) {
      svg.line(px(mark_s), plot.y, px(mark_s), plot.y + plot.height, "hair s-grid");
    }
  }
}

std::string rate_text(double rate_hz) { return number_text(rate_hz, rate_hz < 9.95 ? 1 : 0) + " Hz"; }

void draw_side_rates(SvgBody& svg, const LaneLayout& layout, const std::vector<double>& rates_hz, const Box& plot,
                     double right_px) {
  const double top_hz = rates_hz.empty() ? 1 : std::max(1e-9, *std::max_element(rates_hz.begin(), rates_hz.end()));
  const double bar_px = right_px - (plot.x + plot.width) - kSidePx;
  for (std::size_t k = 0; k < layout.lanes.size(); ++k) {
    const Lane& lane = layout.lanes[k];
    const double middle = plot.y + lane.y_px + lane.height_px / 2;
    if (bar_px > 10) {
      svg.rect({plot.x + plot.width + 5, middle - 4, std::max(0.5, rates_hz[k] / top_hz * bar_px), 8}, "f-" + lane.ink,
               0.75);
    }
    svg.text(right_px, middle + 4, rate_text(rates_hz[k]), "f-muted end");
  }
}

std::string rate_commands(const std::vector<double>& rate_hz, double peak_hz, const Lane& lane, const Box& plot,
                          bool is_closed) {
  const double bottom = plot.y + lane.y_px + lane.height_px;
  const double bin_px = plot.width / std::max<double>(1, static_cast<double>(rate_hz.size()));
  std::string commands = fmt::format("M{} {}", coordinate(plot.x), coordinate(bottom));
  double held = -1;
  for (std::size_t k = 0; k < rate_hz.size(); ++k) {
    const double height = peak_hz > 0 ? rate_hz[k] / peak_hz * (lane.height_px - 3) : 0;
    if (height != held) {
      commands += fmt::format("H{:.1f}V{:.1f}", plot.x + static_cast<double>(k) * bin_px, bottom - height);
      held = height;
    }
  }
  commands += fmt::format("H{:.1f}", plot.x + plot.width);
  return is_closed ? commands + fmt::format("V{:.1f}Z", bottom) : commands;
}

void draw_overlay_lane(SvgBody& svg, const std::vector<RasterGrid>& grids, const std::vector<OverlayRaster>& rasters,
                       const Lane& lane, const Box& plot) {
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const double row_px = lane.height_px / static_cast<double>(grids[g].rows);
    const auto paths = raster_paths(grids[g], {plot.x, plot.y + lane.y_px, plot.width, lane.height_px});
    for (std::size_t level = 0; level < kDarknessLevels; ++level) {
      svg.path(paths[level], "s-" + rasters[g].ink,
               fmt::format("stroke-width=\"{}\" stroke-opacity=\"{}\"",
                           coordinate(std::clamp(row_px * 0.85, 1.0, 10.0)), kDarkness[level]));
    }
  }
}

template <typename Plot>
std::string responsive_plot(const Plot& plot, const std::string& description) {
  std::string svgs;
  for (const double width : {kWidePx, kNarrowPx}) {
    SvgBody svg;
    plot.draw(svg, {0, 0, width, plot.height_px()});
    svgs += inline_svg(svg, width, plot.height_px(), width == kWidePx ? "wide chart" : "narrow chart", description);
  }
  return svgs;
}

}  // namespace

RasterPlot::RasterPlot(const Recording& recording, const std::vector<PopulationSummary>& summaries,
                       LanePlotOptions options)
    : recording_(recording), summaries_(summaries), options_(std::move(options)) {}

double RasterPlot::height_px() const {
  return plot_height_px(lay_out_lanes(recording_, summaries_, {options_.max_lane_px, 0}));
}

void RasterPlot::draw(SvgBody& svg, const Box& box) const {
  const LaneLayout layout = lay_out_lanes(recording_, summaries_, {options_.max_lane_px, 0});
  const Box plot = plot_box(recording_, layout, box);
  const LaneWindow& window = options_.window;
  draw_marks(svg, options_, plot);
  draw_lane_frame(svg, recording_, layout, plot, box.x, window.begin_s, window.end_s);
  const auto columns = static_cast<std::size_t>(plot.width);
  std::vector<RasterGrid> grids = raster_grids(recording_, layout, window.begin_s, window.end_s, columns);
  std::vector<std::size_t> runs;
  for (const RasterGrid& grid : grids) {
    runs.push_back(count_runs(grid));
  }
  const std::size_t runs_a_lane = fair_cap(runs, options_.max_runs);
  std::vector<double> rates_hz;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const Lane& lane = layout.lanes[k];
    const RasterGrid grid = coarsen(std::move(grids[k]), runs_a_lane);
    const double neurons = std::max<double>(1, recording_.populations[lane.population].size);
    rates_hz.push_back(static_cast<double>(grid.spikes) / neurons / std::max(1e-9, window.end_s - window.begin_s));
    const double row_px = lane.height_px / static_cast<double>(grid.rows);
    const auto paths = raster_paths(grid, {plot.x, plot.y + lane.y_px, plot.width, lane.height_px});
    for (std::size_t level = 0; level < kDarknessLevels; ++level) {
      svg.path(paths[level], "s-" + lane.ink,
               fmt::format("stroke-width=\"{}\" stroke-opacity=\"{}\"", coordinate(std::min(row_px * 0.85, 10.0)),
                           kDarkness[level]));
    }
  }
  draw_side_rates(svg, layout, rates_hz, plot, box.x + box.width);
}

std::string RasterPlot::responsive(const std::string& description) const { return responsive_plot(*this, description); }

RatePlot::RatePlot(const Recording& recording, const std::vector<PopulationSummary>& summaries, LanePlotOptions options)
    : recording_(recording), summaries_(summaries), options_(std::move(options)) {}

double RatePlot::height_px() const { return plot_height_px(lay_out_lanes(recording_, summaries_, {0, kRateLanePx})); }

void RatePlot::draw(SvgBody& svg, const Box& box) const {
  const LaneLayout layout = lay_out_lanes(recording_, summaries_, {0, kRateLanePx});
  const Box plot = plot_box(recording_, layout, box);
  draw_marks(svg, options_, plot);
  draw_lane_frame(svg, recording_, layout, plot, box.x, options_.window.begin_s, options_.window.end_s);
  const std::vector<PopulationRate> rates =
      population_rates(recording_, {options_.window.begin_s, options_.window.end_s, kRateBinS});
  for (const Lane& lane : layout.lanes) {
    const std::vector<double>& rate_hz = rates[lane.population].rate_hz;
    const double peak_hz = rate_hz.empty() ? 0 : *std::max_element(rate_hz.begin(), rate_hz.end());
    svg.path(rate_commands(rate_hz, peak_hz, lane, plot, true), "f-" + lane.ink, "opacity=\"0.35\"");
    svg.path(rate_commands(rate_hz, peak_hz, lane, plot, false), "ln s-" + lane.ink, "stroke-width=\"1.2\"");
    svg.text(box.x + box.width, plot.y + lane.y_px + lane.height_px / 2 + 4, rate_text(peak_hz), "f-muted end");
  }
}

std::string RatePlot::responsive(const std::string& description) const { return responsive_plot(*this, description); }

OverlayPlot::OverlayPlot(std::vector<OverlayRaster> rasters, const std::vector<PopulationSummary>& summaries,
                         LanePlotOptions options)
    : rasters_(std::move(rasters)), summaries_(summaries), options_(std::move(options)) {}

double OverlayPlot::height_px() const {
  return plot_height_px(lay_out_lanes(*rasters_.front().recording, summaries_, {options_.max_lane_px, 0}));
}

void OverlayPlot::draw(SvgBody& svg, const Box& box) const {
  const Recording& recording = *rasters_.front().recording;
  const LaneLayout layout = lay_out_lanes(recording, summaries_, {options_.max_lane_px, 0});
  Box plot = plot_box(recording, layout, box);
  plot.width = box.x + box.width - plot.x;  // no rates at the side
  const LaneWindow& window = options_.window;
  draw_marks(svg, options_, plot);
  draw_lane_frame(svg, recording, layout, plot, box.x, window.begin_s, window.end_s);
  std::vector<std::vector<RasterGrid>> lanes(layout.lanes.size());  // a grid of each raster
  for (const OverlayRaster& raster : rasters_) {
    std::vector<RasterGrid> grids =
        raster_grids(*raster.recording, layout, window.begin_s, window.end_s, static_cast<std::size_t>(plot.width));
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      lanes[k].push_back(std::move(grids[k]));
    }
  }
  std::vector<std::size_t> runs;
  for (const std::vector<RasterGrid>& grids : lanes) {
    runs.push_back(count_overlay_runs(grids));
  }
  const std::size_t runs_a_lane = fair_cap(runs, options_.max_runs);
  for (std::size_t k = 0; k < lanes.size(); ++k) {
    draw_overlay_lane(svg, coarsen_overlay(std::move(lanes[k]), runs_a_lane), rasters_, layout.lanes[k], plot);
  }
}

std::string OverlayPlot::responsive(const std::string& description) const {
  return responsive_plot(*this, description);
}

}  // namespace tectum
