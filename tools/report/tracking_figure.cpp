#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/run_summary.h"
#include "tools/report/lane_plot.h"
#include "tools/report/run_figures.h"
#include "tools/report/run_report.h"

namespace tectum {
namespace {

constexpr double kWidthPx = 1200;
constexpr double kPadPx = 24;
constexpr double kExcerptS = 20;
constexpr double kRasterS = 2;
constexpr double kTracePx = 230;
constexpr double kWallPx = 420;
constexpr double kSmallPx = 280;
constexpr double kColumnPx = 450;

std::string headline(const Recording& recording, const RunSummary& summary) {
  std::string text = fmt::format("{}, scenario {}, seed {}, {} s", recording.circuit_name, recording.scenario,
                                 recording.seed, number_text(summary.duration_s, 0));
  if (summary.tracking.has_truth) {
    const auto& eyes = summary.tracking.eye;
    text += fmt::format(": RMSE left {}° H, {}° V; right {}° H, {}° V", number_text(eyes[0].pan.all.rmse_deg, 2),
                        number_text(eyes[0].tilt.all.rmse_deg, 2), number_text(eyes[1].pan.all.rmse_deg, 2),
                        number_text(eyes[1].tilt.all.rmse_deg, 2));
  }
  return text;
}

/// The two seconds of the excerpt in which the left eye moved most.
LaneWindow busy_window(const RunSummary& summary, const LaneWindow& excerpt) {
  const double length_s = std::min(kRasterS, excerpt.end_s - excerpt.begin_s);
  const auto window = [&](double from_s) {
    const double begin_s = std::clamp(from_s, excerpt.begin_s, std::max(excerpt.begin_s, excerpt.end_s - length_s));
    return LaneWindow{begin_s, begin_s + length_s};
  };
  LaneWindow best = window(excerpt.begin_s);
  double most_deg = 0;
  for (const Saccade& first : summary.saccades[0].saccades) {
    const LaneWindow candidate = window(first.onset_s - 0.3);
    double moved_deg = 0;
    for (const Saccade& saccade : summary.saccades[0].saccades) {
      const bool is_inside = saccade.onset_s >= candidate.begin_s && saccade.offset_s < candidate.end_s;
      moved_deg += is_inside ? saccade.amplitude_deg : 0;
    }
    if (moved_deg > most_deg) {
      most_deg = moved_deg;
      best = candidate;
    }
  }
  return best;
}

void panel_title(SvgBody& svg, double x, double y, const std::string& title) { svg.text(x, y, title, "b f-fg"); }

/// Left of the raster: the wall, and below it as many small charts as the raster is high. Returns where it ends.
double draw_column(SvgBody& svg, const Recording& recording, const RunSummary& summary, const LaneWindow& excerpt,
                   double y, double limit_y) {
  panel_title(svg, kPadPx, y, "Path on the wall");
  draw_chart(svg, wall_chart(recording, excerpt), {kPadPx, y + 8, kColumnPx, kWallPx});
  y += kWallPx + 34;
  const std::array<std::pair<const char*, Chart>, 3> small = {
      {{"Saccades", main_sequence_chart(summary)},
       {"Horizontal error, whole run", error_histogram(recording, GazeAxis::Horizontal)},
       {"Vertical error, whole run", error_histogram(recording, GazeAxis::Vertical)}}};
  for (std::size_t k = 0; k < small.size() && (k == 0 || y + kSmallPx <= limit_y); ++k) {
    panel_title(svg, kPadPx, y, small[k].first);
    draw_chart(svg, small[k].second, {kPadPx, y + 8, kColumnPx, kSmallPx});
    y += kSmallPx + 34;
  }
  return y - 26;
}

}  // namespace

std::string tracking_svg(const Recording& recording) {
  const RunSummary summary = summarize_run(recording);
  const TimeRange range = time_range(recording);
  const LaneWindow excerpt{range.begin_s, std::min(range.begin_s + kExcerptS, range.end_s)};
  const std::vector<double>& jumps_s = summary.tracking.target_jumps_s;
  SvgBody svg;
  svg.text(kPadPx, 34, "Eyes on the target", "big b f-fg");
  svg.text(kPadPx, 56, headline(recording, summary), "f-muted");
  double y = 84;
  const double full_px = kWidthPx - 2 * kPadPx;
  for (const GazeAxis axis : {GazeAxis::Horizontal, GazeAxis::Vertical}) {
    panel_title(svg, kPadPx, y, axis == GazeAxis::Horizontal ? "Horizontal direction" : "Vertical direction");
    draw_chart(svg, gaze_chart(recording, axis, excerpt, jumps_s), {kPadPx, y + 8, full_px, kTracePx});
    y += kTracePx + 30;
  }
  const LaneWindow burst = busy_window(summary, excerpt);
  const RasterPlot raster(recording, summary.populations,
                          {.window = burst, .max_lane_px = 22, .max_runs = 30'000, .marks_s = jumps_s, .shades = {}});
  const double raster_x = kPadPx + kColumnPx + 40;
  panel_title(svg, raster_x, y,
              fmt::format("Spikes, {} to {} s", number_text(burst.begin_s, 1), number_text(burst.end_s, 1)));
  raster.draw(svg, {raster_x, y + 16, kWidthPx - kPadPx - raster_x, 0});
  const double column_end = draw_column(svg, recording, summary, excerpt, y, y + raster.height_px() + 16);
  y = std::max(column_end, y + raster.height_px() + 16) + kPadPx;
  return standalone_svg(svg, kWidthPx, y, "tracking: target and both eyes over time, path on the wall, spikes");
}

}  // namespace tectum
