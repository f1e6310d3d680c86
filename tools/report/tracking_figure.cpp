#include <fmt/format.h>

#include <algorithm>

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
constexpr double kRasterS = 4;
constexpr double kTracePx = 230;
constexpr double kWallPx = 500;

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

void panel_title(SvgBody& svg, double x, double y, const std::string& title) { svg.text(x, y, title, "b f-fg"); }

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
  const LaneWindow burst = zoom_window(recording, jumps_s, std::min(kRasterS, excerpt.end_s - excerpt.begin_s),
                                       jumps_s.empty() ? std::optional<double>() : jumps_s[jumps_s.size() / 3] - 0.3);
  const RasterPlot raster(recording, {burst, true, 40'000, jumps_s, {}});
  panel_title(svg, kPadPx, y, "Path on the wall");
  draw_chart(svg, wall_chart(recording, excerpt), {kPadPx, y + 8, 480, kWallPx});
  panel_title(svg, kPadPx + 520, y, fmt::format("Spikes, {} s", number_text(burst.end_s - burst.begin_s, 0)));
  raster.draw(svg, {kPadPx + 520, y + 16, full_px - 520, 0});
  y += std::max(kWallPx + 8, raster.height_px() + 16) + kPadPx;
  return standalone_svg(svg, kWidthPx, y, "tracking: target and both eyes over time, path on the wall, spikes");
}

}  // namespace tectum
