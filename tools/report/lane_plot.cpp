#include "tools/report/lane_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/population_rates.h"
#include "tools/report/chart.h"
#include "tools/report/lane_layout.h"

namespace tectum {
namespace {

constexpr double kRateBinS = 0.02;
constexpr double kSidePx = 52;  // "1234 Hz"
constexpr double kBarPx = 46;   // room for the bars on wide pictures
constexpr double kWideFromPx = 600;
constexpr double kRasterRowPx = 0.5;  // finer rows than this cannot be told apart

/// Spikes of one lane on a grid of rows by time columns.
struct LaneGrid {
  std::size_t rows = 1;
  std::vector<std::vector<std::uint32_t>> columns_of_row;  // ascending
};

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

/// Sorts the window's spikes into grid cells, all lanes at once. Spikes are in time order, so each row's columns
/// ascend.
std::vector<LaneGrid> fill_grids(const Recording& recording, const std::vector<double>& times_s,
                                 const LaneLayout& layout, const LaneWindow& window, double plot_px) {
  std::vector<std::size_t> lane_of_population(recording.populations.size(), layout.lanes.size());
  std::vector<LaneGrid> grids(layout.lanes.size());
  for (std::size_t k = 0; k < layout.lanes.size(); ++k) {
    const RecordedPopulation& population = recording.populations[layout.lanes[k].population];
    lane_of_population[layout.lanes[k].population] = k;
    grids[k].rows =
        std::clamp<std::size_t>(population.size, 1, static_cast<std::size_t>(layout.lanes[k].height_px / kRasterRowPx));
    grids[k].columns_of_row.resize(grids[k].rows);
  }
  std::vector<std::size_t> order(recording.populations.size());
  for (std::size_t p = 0; p < order.size(); ++p) {
    order[p] = p;
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return recording.populations[a].first_neuron < recording.populations[b].first_neuron;
  });
  const double px_per_s = plot_px / std::max(1e-9, window.end_s - window.begin_s);
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    if (times_s[k] < window.begin_s || times_s[k] >= window.end_s) {
      continue;
    }
    const std::uint32_t neuron = recording.spikes[k].neuron;
    const auto after = std::upper_bound(order.begin(), order.end(), neuron, [&](std::uint32_t id, std::size_t p) {
      return id < recording.populations[p].first_neuron;
    });
    if (after == order.begin()) {
      continue;
    }
    const std::size_t p = *(after - 1);
    const std::size_t row = neuron - recording.populations[p].first_neuron;
    if (row >= recording.populations[p].size || lane_of_population[p] == layout.lanes.size()) {
      continue;
    }
    LaneGrid& grid = grids[lane_of_population[p]];
    const auto column = static_cast<std::uint32_t>((times_s[k] - window.begin_s) * px_per_s);
    grid.columns_of_row[row * grid.rows / recording.populations[p].size].push_back(column);
  }
  return grids;
}

/// Calls `emit(row, begin, end)` for each run of touched columns, `merge` columns taken as one.
template <typename Emit>
void for_each_run(const LaneGrid& grid, std::uint32_t merge, Emit emit) {
  for (std::size_t row = 0; row < grid.columns_of_row.size(); ++row) {
    const std::vector<std::uint32_t>& columns = grid.columns_of_row[row];
    for (std::size_t k = 0; k < columns.size();) {
      const std::uint32_t begin = columns[k] / merge;
      std::uint32_t end = begin + 1;
      while (k < columns.size() && columns[k] / merge <= end) {
        end = std::max(end, columns[k] / merge + 1);
        ++k;
      }
      emit(row, begin * merge, end * merge);
    }
  }
}

std::string raster_commands(const LaneGrid& grid, std::uint32_t merge, const Lane& lane, const Box& plot) {
  std::string commands;
  const double row_px = lane.height_px / static_cast<double>(grid.rows);
  for_each_run(grid, merge, [&](std::size_t row, std::uint32_t begin, std::uint32_t end) {
    const double y = plot.y + lane.y_px + (static_cast<double>(row) + 0.5) * row_px;
    commands += fmt::format("M{} {}h{}", coordinate(plot.x + begin), coordinate(y),
                            std::min(end - begin, static_cast<std::uint32_t>(plot.width) -
                                                      std::min(begin, static_cast<std::uint32_t>(plot.width))));
  });
  return commands;
}

std::size_t count_runs(const std::vector<LaneGrid>& grids, std::uint32_t merge) {
  std::size_t runs = 0;
  for (const LaneGrid& grid : grids) {
    for_each_run(grid, merge, [&](std::size_t, std::uint32_t, std::uint32_t) { ++runs; });
  }
  return runs;
}

/// Mean rate of each lane over the window.
std::vector<double> window_rates(const Recording& recording, const LaneLayout& layout, const LaneWindow& window) {
  const std::vector<PopulationRate> all =
      population_rates(recording, {window.begin_s, window.end_s, std::max(1e-9, window.end_s - window.begin_s)});
  std::vector<double> rates_hz;
  for (const Lane& lane : layout.lanes) {
    const std::vector<double>& bins = all[lane.population].rate_hz;
    rates_hz.push_back(bins.empty() ? 0 : bins.front());
  }
  return rates_hz;
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

RasterPlot::RasterPlot(const Recording& recording, LanePlotOptions options)
    : recording_(recording), options_(std::move(options)) {}

double RasterPlot::height_px() const {
  return plot_height_px(lay_out_lanes(recording_, options_.omits_silent, LaneHeight::ByNeurons));
}

void RasterPlot::draw(SvgBody& svg, const Box& box) const {
  const LaneLayout layout = lay_out_lanes(recording_, options_.omits_silent, LaneHeight::ByNeurons);
  const Box plot = plot_box(recording_, layout, box);
  draw_marks(svg, options_, plot);
  draw_lane_frame(svg, recording_, layout, plot, box.x, options_.window.begin_s, options_.window.end_s);
  const std::vector<LaneGrid> grids =
      fill_grids(recording_, spike_times_s(recording_), layout, options_.window, plot.width);
  std::uint32_t merge = 1;
  while (merge < 64 && count_runs(grids, merge) > options_.max_runs) {
    merge *= 2;
  }
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const double row_px = layout.lanes[k].height_px / static_cast<double>(grids[k].rows);
    svg.path(raster_commands(grids[k], merge, layout.lanes[k], plot), "s-" + layout.lanes[k].ink,
             fmt::format("stroke-width=\"{}\"", coordinate(std::clamp(row_px * 0.8, kRasterRowPx, 12.0))));
  }
  draw_side_rates(svg, layout, window_rates(recording_, layout, options_.window), plot, box.x + box.width);
}

std::string RasterPlot::responsive(const std::string& description) const { return responsive_plot(*this, description); }

RatePlot::RatePlot(const Recording& recording, LanePlotOptions options)
    : recording_(recording), options_(std::move(options)) {}

double RatePlot::height_px() const {
  return plot_height_px(lay_out_lanes(recording_, options_.omits_silent, LaneHeight::Equal));
}

void RatePlot::draw(SvgBody& svg, const Box& box) const {
  const LaneLayout layout = lay_out_lanes(recording_, options_.omits_silent, LaneHeight::Equal);
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

}  // namespace tectum
