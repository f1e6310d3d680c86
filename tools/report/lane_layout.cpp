#include "tools/report/lane_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/report/chart.h"
#include "tools/report/theme.h"

namespace tectum {
namespace {

constexpr double kMinLanePx = 14;  // a line of type
constexpr double kNeuronPx = 2.5;
constexpr double kGroupGapPx = 5;

std::string nucleus_of(const RecordedPopulation& population) {
  return population.nucleus.empty() ? std::string("other") : population.nucleus;
}

}  // namespace

LaneLayout lay_out_lanes(const Recording& recording, const std::vector<PopulationSummary>& summaries,
                         LaneHeights heights) {
  LaneLayout layout;
  std::vector<std::string> nuclei;
  for (std::size_t p = 0; p < recording.populations.size(); ++p) {
    if (summaries[p].spikes == 0) {
      layout.silent.push_back(p);
    } else if (const std::string nucleus = nucleus_of(recording.populations[p]);
               std::find(nuclei.begin(), nuclei.end(), nucleus) == nuclei.end()) {
      nuclei.push_back(nucleus);
    }
  }
  double y_px = 0;
  for (std::size_t n = 0; n < nuclei.size(); ++n) {
    LaneGroup group{nuclei[n], category_ink(n), y_px, layout.lanes.size(), 0};
    y_px += kLaneHeadingPx;
    for (std::size_t p = 0; p < recording.populations.size(); ++p) {
      const RecordedPopulation& population = recording.populations[p];
      if (nucleus_of(population) != nuclei[n] || summaries[p].spikes == 0) {
        continue;
      }
      const double lane_px = heights.equal_px > 0 ? heights.equal_px
                                                  : std::clamp(population.size * kNeuronPx, kMinLanePx,
                                                               std::max(kMinLanePx, heights.max_lane_px));
      layout.lanes.push_back({p, group.ink, y_px, lane_px});
      ++group.lane_count;
      y_px += lane_px + 1;
    }
    layout.groups.push_back(group);
    y_px += kGroupGapPx;
  }
  layout.lanes_px = std::max(y_px, kMinLanePx);
  return layout;
}

double lane_label_px(const Recording& recording, const LaneLayout& layout, double width_px) {
  double label_px = 40;
  for (const Lane& lane : layout.lanes) {
    label_px = std::max(label_px, text_width_px(recording.populations[lane.population].name) + 16);
  }
  return std::min(label_px, width_px / 3);
}

void draw_lane_frame(SvgBody& svg, const Recording& recording, const LaneLayout& layout, const Box& plot,
                     double left_px, double begin_s, double end_s) {
  for (const LaneGroup& group : layout.groups) {
    svg.text(left_px, plot.y + group.y_px + 13, group.nucleus, "b f-" + group.ink);
    if (group.lane_count > 0) {
      const Lane& first = layout.lanes[group.first_lane];
      const Lane& last = layout.lanes[group.first_lane + group.lane_count - 1];
      svg.rect({left_px, plot.y + first.y_px, 3, last.y_px + last.height_px - first.y_px}, "f-" + group.ink);
    }
  }
  for (const Lane& lane : layout.lanes) {
    const std::string name = fit_text(recording.populations[lane.population].name, plot.x - left_px - 14);
    svg.text(left_px + 9, plot.y + lane.y_px + lane.height_px / 2 + 4, name, "f-fg");
    svg.line(plot.x, plot.y + lane.y_px + lane.height_px + 0.5, plot.x + plot.width,
             plot.y + lane.y_px + lane.height_px + 0.5, "hair s-grid");
  }
  const double bottom = plot.y + layout.lanes_px;
  svg.line(plot.x, bottom, plot.x + plot.width, bottom, "hair s-muted");
  const Ticks ticks = nice_ticks(begin_s, end_s, std::max(2, static_cast<int>(plot.width / 65)));
  for (int k = 0; k < ticks.count; ++k) {
    const double time_s = ticks.first + k * ticks.step;
    const double x = plot.x + (time_s - begin_s) / std::max(1e-9, end_s - begin_s) * plot.width;
    svg.line(x, bottom, x, bottom + 4, "hair s-muted");
    svg.text(x, bottom + 16, number_text(time_s, ticks.decimals), "f-muted mid");
  }
  svg.text(plot.x + plot.width, bottom + 31, "time (s)", "f-muted end");
  if (!layout.silent.empty()) {
    std::string names;
    for (const std::size_t p : layout.silent) {
      names += (names.empty() ? "" : ", ") + recording.populations[p].name;
    }
    svg.text(left_px, bottom + kLaneAxisPx + 12,
             fit_text(fmt::format("silent ({}): {}", layout.silent.size(), names), plot.x + plot.width - left_px),
             "f-muted");
  }
}

}  // namespace tectum
