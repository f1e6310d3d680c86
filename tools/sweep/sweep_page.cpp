// Heat maps: rows of coloured cells over the first two axes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/report/report_page.h"
#include "tools/report/svg.h"
#include "tools/sweep/sweep_means.h"
#include "tools/sweep/sweep_output.h"

namespace tectum {
namespace {

constexpr double kFaintest = 0.06;  // of the least value, so that its cell still shows
// What to write in so that every cell has a contrast of 3 : 1 and more: on a light page dark up to kWhiteFrom, on a
// dark page light up to kDarkFrom.
constexpr double kDarkFrom = 0.6;
constexpr double kWhiteFrom = 0.87;
constexpr std::string_view kCellStyle = "<style>.f-dark{fill:#14171a}</style>\n";
constexpr double kRowPx = 26;
constexpr double kLabelPx = 7.2;  // a letter of an axis's value, at 12 px

struct MapAxes {
  std::optional<std::size_t> across, down;
};

/// The first two that have more than one value; the seed only where a parameter is missing.
MapAxes axes_of(const std::vector<SweepAxis>& axes) {
  std::vector<std::size_t> order;
  for (const bool is_seed : {false, true}) {
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if ((axes[a].name == kSeedAxis) == is_seed && axes[a].values.size() > 1) {
        order.push_back(a);
      }
    }
  }
  MapAxes map;
  if (!order.empty()) {
    map.across = order[0];
  }
  if (order.size() > 1) {
    map.down = order[1];
  }
  return map;
}

std::string title_of(const SweepAxis& axis) {
  const std::size_t blank = axis.values.front().find(' ');
  return blank == std::string::npos ? axis.name
                                    : fmt::format("{} ({})", axis.name, axis.values.front().substr(blank + 1));
}

/// Without the unit, which the title has, and with as many decimals each: 0.36, 0.40.
std::vector<std::string> labels_of(const SweepAxis& axis) {
  const auto decimals_of = [](const std::string& label) {
    const std::size_t point = label.find('.');
    return point == std::string::npos ? 0 : label.size() - point - 1;
  };
  std::vector<std::string> labels;
  std::size_t decimals = 0;
  bool are_plain = true;
  for (const std::string& value : axis.values) {
    labels.push_back(value.substr(0, value.find(' ')));
    decimals = std::max(decimals, decimals_of(labels.back()));
    are_plain = are_plain && labels.back().find_first_not_of("-.0123456789") == std::string::npos;
  }
  for (std::string& label : labels) {
    if (are_plain && decimals > decimals_of(label)) {
      label += label.find('.') == std::string::npos ? "." : "";
      label.append(decimals - decimals_of(label), '0');
    }
  }
  return labels;
}

class HeatMap {
 public:
  HeatMap(const SweepPlan& plan, const MapAxes& map, std::size_t measure, double width_px)
      : plan_(plan), map_(map), measure_(measure), width_px_(width_px) {
    columns_ = map.across ? plan.axes[*map.across].values.size() : 1;
    rows_ = map.down ? plan.axes[*map.down].values.size() : 1;
    std::size_t letters = 0;
    if (map.down) {
      letters = plan.axes[*map.down].name == kSeedAxis ? 5 : 0;  // "mean", in bold
      for (const std::string& label : labels_of(plan.axes[*map.down])) {
        letters = std::max(letters, label.size());
      }
    }
    left_px_ = 10 + kLabelPx * static_cast<double>(letters);
    cell_px_ = (width_px - left_px_ - 4) / static_cast<double>(columns_);
  }

  /// `column_means` are the last row, where there is one.
  std::string svg(const std::vector<MeanOverRest>& means, const std::vector<MeanOverRest>& column_means,
                  const char* css) {
    const auto [least, most] = std::minmax_element(
        means.begin(), means.end(), [](const MeanOverRest& a, const MeanOverRest& b) { return a.mean < b.mean; });
    least_ = least->mean;
    most_ = most->mean;
    draw_scale();
    for (const MeanOverRest& each : means) {
      draw_cell(each, row_y_px(map_.down ? each.point[*map_.down] : 0));
    }
    double bottom_px = row_y_px(rows_);
    if (!column_means.empty()) {
      bottom_px += kMeanGapPx;
      for (const MeanOverRest& each : column_means) {
        draw_cell(each, bottom_px);
      }
      body_.text(left_px_ - 6, bottom_px + 17, "mean", "f-muted end b");
      bottom_px += kRowPx;
    }
    draw_labels(bottom_px);
    return inline_svg(body_, width_px_, bottom_px + kBottomPx, css, kSweepMeasures[measure_].title);
  }

 private:
  static constexpr double kTopPx = 26, kBottomPx = 40, kMeanGapPx = 5;

  static double row_y_px(std::size_t row) { return kTopPx + kRowPx * static_cast<double>(row); }
  static double opacity_of(double share) { return kFaintest + (1 - kFaintest) * share; }

  /// The colours from the least to the most value, at the right above the map.
  void draw_scale() {
    if (!(most_ > least_)) {
      return;
    }
    constexpr int kSteps = 24;
    constexpr double kStepPx = 4;
    const std::string low = number_text(least_, kSweepMeasures[measure_].decimals);
    const std::string high = number_text(most_, kSweepMeasures[measure_].decimals);
    const double right = width_px_ - 8 - text_width_px(high);
    const double left = right - kSteps * kStepPx;
    for (int k = 0; k < kSteps; ++k) {
      body_.rect({left + k * kStepPx, 3, kStepPx, 10}, "f-left", opacity_of(k / (kSteps - 1.0)));
    }
    body_.text(left - 6, 12, low, "f-muted end");
    body_.text(right + 6, 12, high, "f-muted");
    title_room_px_ = left - 20 - text_width_px(low);
  }

  void draw_cell(const MeanOverRest& each, double y_px) {
    const double opacity = opacity_of(most_ > least_ ? (each.mean - least_) / (most_ - least_) : 0);
    const std::size_t column = map_.across ? each.point[*map_.across] : 0;
    const Box box{left_px_ + cell_px_ * static_cast<double>(column), y_px, cell_px_ - 1, kRowPx - 1};
    body_.rect(box, "f-left", opacity);
    const std::string text = number_text(each.mean, kSweepMeasures[measure_].decimals);
    if (text_width_px(text, 10.5) + 2 < box.width) {
      const std::string_view ink = opacity > kWhiteFrom ? "f-bg" : opacity > kDarkFrom ? "f-dark" : "f-fg";
      body_.text(box.x + box.width / 2, box.y + 16.5, text, fmt::format("{} small mid", ink));
    }
  }

  void draw_labels(double bottom_px) {
    if (map_.down) {
      const SweepAxis& axis = plan_.axes[*map_.down];
      body_.text(0, 12, fit_text(title_of(axis), title_room_px_), "f-muted");
      const std::vector<std::string> labels = labels_of(axis);
      for (std::size_t row = 0; row < rows_; ++row) {
        body_.text(left_px_ - 6, row_y_px(row) + 17, labels[row], "f-muted end");
      }
    }
    if (!map_.across) {
      return;
    }
    const SweepAxis& axis = plan_.axes[*map_.across];
    const std::vector<std::string> labels = labels_of(axis);
    double widest_px = 0;
    for (const std::string& label : labels) {
      widest_px = std::max(widest_px, text_width_px(label));
    }
    // Every so many, so that they do not touch.
    const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil((widest_px + 8) / cell_px_)));
    for (std::size_t column = 0; column < columns_; column += stride) {
      const double middle = left_px_ + cell_px_ * (static_cast<double>(column) + 0.5);
      body_.text(std::min(middle, width_px_ - text_width_px(labels[column]) / 2), bottom_px + 15, labels[column],
                 "f-muted mid");
    }
    body_.text(left_px_ + (width_px_ - left_px_) / 2, bottom_px + 33, title_of(axis), "f-muted mid");
  }

  const SweepPlan& plan_;
  const MapAxes map_;
  std::size_t measure_;
  double width_px_, left_px_ = 0, cell_px_ = 0;
  double least_ = 0, most_ = 0, title_room_px_ = 1e9;
  std::size_t columns_ = 1, rows_ = 1;
  SvgBody body_;
};

std::string subtitle_of(const SweepPlan& plan, const SweepResult& result) {
  return fmt::format("{}, protocol {}, {} s each: {} runs", plan.circuit_path, plan.protocol.name,
                     plan.protocol.duration_s, result.points.size());
}

/// How each axis is drawn.
std::string drawn_text(const SweepPlan& plan, const MapAxes& map) {
  std::string drawn, averaged, fixed;
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    const SweepAxis& axis = plan.axes[a];
    if (map.across == a || map.down == a) {
      drawn += fmt::format("{}{} {}", drawn.empty() ? "" : ", ", axis.name, map.across == a ? "across" : "down");
    } else if (axis.values.size() > 1) {
      averaged += fmt::format("{}{} values of {}", averaged.empty() ? "" : " and the ", axis.values.size(), axis.name);
    } else {
      fixed += fmt::format("{}{} = {}", fixed.empty() ? "" : ", ", axis.name, axis.values.front());
    }
  }
  std::string text = drawn.empty() ? "" : "In the maps: " + drawn + ". ";
  text += averaged.empty() ? "Each cell is one run" : "Each cell is the mean over the " + averaged;
  text += fixed.empty() ? "." : ", at " + fixed + ".";
  text += map.down && plan.axes[*map.down].name == kSeedAxis ? " The last row is the mean over the seeds." : "";
  return text + " The stronger the colour, the higher the value; each map has its own scale.";
}

}  // namespace

std::string sweep_page(const SweepPlan& plan, const SweepResult& result, const std::string& command) {
  constexpr double kWide = 1000, kNarrow = 400;
  const MapAxes map = axes_of(plan.axes);
  std::vector<std::size_t> in_view;
  for (const std::optional<std::size_t>& axis : {map.across, map.down}) {
    if (axis) {
      in_view.push_back(*axis);
    }
  }
  const bool has_seeds_down = map.down && plan.axes[*map.down].name == kSeedAxis;
  ReportPage page;
  page.html(kCellStyle);
  const bool has_seeds = std::any_of(plan.axes.begin(), plan.axes.end(), [](const SweepAxis& axis) {
    return axis.name == kSeedAxis && axis.values.size() > 1;
  });
  ReportTable table{{has_seeds ? "mean over the seeds" : "one run each", "least", "most"}, {}, {}, true};
  for (const MeasureExtremes& each : extremes_of(plan, result)) {
    table.rows.push_back({each.title, each.least, each.most});
  }
  page.table(table);
  page.paragraph(drawn_text(plan, map));
  for (const std::size_t m : kMainMeasures) {
    const std::vector<MeanOverRest> means = means_over_rest(plan, result, in_view, m);
    if (means.empty()) {
      continue;
    }
    const std::vector<MeanOverRest> column_means =
        has_seeds_down ? means_over_rest(plan, result, {*map.across}, m) : std::vector<MeanOverRest>{};
    page.figure(kSweepMeasures[m].title, "",
                HeatMap(plan, map, m, kWide).svg(means, column_means, "wide") +
                    HeatMap(plan, map, m, kNarrow).svg(means, column_means, "narrow"));
  }
  page.paragraph("Every run's numbers stand in sweep.csv beside this page. Made by: " + command);
  return page.finish("Sweep", subtitle_of(plan, result));
}

}  // namespace tectum
