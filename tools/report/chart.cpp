#include "tools/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tectum {
namespace {

constexpr double kFontPx = 12;
constexpr double kLegendLinePx = 18;
constexpr double kRightMarginPx = 10;
constexpr double kBottomMarginPx = 36;
constexpr double kSwatchPx = 18;

struct Range {
  double low = 0;
  double high = 1;
  double step = 1;  // between ticks
  [[nodiscard]] double span() const { return high - low; }
};

/// Data to pixels.
struct Frame2d {
  Box plot;
  Range x, y;
  [[nodiscard]] double px(double value) const { return plot.x + (value - x.low) / x.span() * plot.width; }
  [[nodiscard]] double py(double value) const {
    return plot.y + plot.height - (value - y.low) / y.span() * plot.height;
  }
};

Range data_range(const std::vector<Series>& all, bool is_x) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 1};
  for (const Series& series : all) {
    for (const double value : is_x ? series.x : series.y) {
      if (std::isfinite(value)) {
        range.low = std::min(range.low, value);
        range.high = std::max(range.high, value);
      }
    }
    if (!is_x && series.kind == SeriesKind::Bars && !series.y.empty()) {
      range.low = std::min(range.low, 0.0);
    }
  }
  return range.low <= range.high ? range : Range{};
}

Range axis_range(const ChartAxis& axis, Range data, int ticks) {
  const double wanted = std::max(axis.min_span, 1e-9);
  if (data.span() < wanted) {
    const double middle = (data.low + data.high) / 2;
    data = {middle - wanted / 2, middle + wanted / 2, 1};
  }
  data = {axis.min.value_or(data.low), axis.max.value_or(data.high), 1};
  if (!(data.span() > 0)) {
    data.high = data.low + 1;
  }
  const double step = nice_ticks(data.low, data.high, ticks).step;
  data.step = step;
  if (!axis.min) {
    data.low = std::floor(data.low / step + 1e-9) * step;
  }
  if (!axis.max) {
    data.high = std::ceil(data.high / step - 1e-9) * step;
  }
  return data;
}

/// The multiples of `step` in [low, high].
Ticks multiples_of(double step, double low, double high) {
  Ticks ticks;
  ticks.step = step;
  ticks.first = std::ceil(low / step - 1e-6) * step;
  ticks.count = static_cast<int>(std::floor((high - ticks.first) / step + 1e-6)) + 1;
  ticks.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return ticks;
}

/// Widens one of the ranges so that both have the same scale.
void equalise(Frame2d& frame) {
  const double per_px = std::max(frame.x.span() / frame.plot.width, frame.y.span() / frame.plot.height);
  const auto widen = [](Range& range, double span) {
    const double middle = (range.low + range.high) / 2;
    range.low = middle - span / 2;
    range.high = middle + span / 2;
  };
  widen(frame.x, per_px * frame.plot.width);
  widen(frame.y, per_px * frame.plot.height);
}

struct LegendEntry {
  const Series* series;
  double x, line;
};

/// Legend entries flow from the right of the y label and wrap; returns the number of lines.
int lay_out_legend(const Chart& chart, const Box& box, std::vector<LegendEntry>& entries) {
  double x = box.x + text_width_px(chart.y.label, kFontPx) + 18;
  int line = 0;
  for (const Series& series : chart.series) {
    if (series.name.empty()) {
      continue;
    }
    const double width = kSwatchPx + 6 + text_width_px(series.name, kFontPx) + 14;
    if (x + width > box.x + box.width && (line > 0 || !chart.y.label.empty()) && x > box.x) {
      x = box.x;
      ++line;
    }
    entries.push_back({&series, x, static_cast<double>(line)});
    x += width;
  }
  return line + 1;
}

void draw_legend(SvgBody& svg, const std::vector<LegendEntry>& entries, double top) {
  for (const LegendEntry& entry : entries) {
    const double y = top + entry.line * kLegendLinePx + 8;
    const Series& series = *entry.series;
    if (series.kind == SeriesKind::Points) {
      svg.circle(entry.x + kSwatchPx / 2, y, 3.5, "f-" + series.ink);
    } else if (series.kind == SeriesKind::Bars) {
      svg.rect({entry.x + 4, y - 5, 10, 10}, "f-" + series.ink, series.opacity);
    } else {
      svg.path(fmt::format("M{} {}h{}", coordinate(entry.x), coordinate(y), coordinate(kSwatchPx)),
               "ln s-" + series.ink + (series.is_dashed ? " dash" : ""),
               fmt::format("stroke-width=\"{}\" opacity=\"{}\"", coordinate(std::max(2.0, series.width_px)),
                           coordinate(series.opacity)));
    }
    svg.text(entry.x + kSwatchPx + 6, y + 4, series.name, "f-fg");
  }
}

Ticks ticks_of(const Range& range) { return multiples_of(range.step, range.low, range.high); }

void draw_axes(SvgBody& svg, const Chart& chart, const Frame2d& frame) {
  const Box& plot = frame.plot;
  const Ticks ys = ticks_of(frame.y);
  for (int k = 0; k < ys.count; ++k) {
    const double value = ys.first + k * ys.step;
    const double y = std::round(frame.py(value)) + 0.5;
    const bool is_zero = std::abs(value) < ys.step * 1e-6;
    svg.line(plot.x, y, plot.x + plot.width, y, is_zero ? "hair s-muted" : "hair s-grid");
    svg.text(plot.x - 6, y + 4, number_text(value, ys.decimals), "f-muted end");
  }
  const Ticks xs = ticks_of(frame.x);
  const double bottom = plot.y + plot.height;
  for (int k = 0; k < xs.count; ++k) {
    const double value = xs.first + k * xs.step;
    const double x = frame.px(value);
    if (chart.has_equal_scales) {
      svg.line(std::round(x) + 0.5, plot.y, std::round(x) + 0.5, bottom, "hair s-grid");
    }
    svg.line(x, bottom, x, bottom + 4, "hair s-muted");
    svg.text(x, bottom + 16, number_text(value, xs.decimals), "f-muted mid");
  }
  svg.line(plot.x, bottom, plot.x + plot.width, bottom, "hair s-muted");
  svg.text(plot.x + plot.width, bottom + 31, chart.x.label, "f-muted end");
}

/// Appends points to a path, keeping of each half-pixel column only its first, lowest, highest and last point: the
/// drawing is the same and a long run stays light.
class ThinnedPath {
 public:
  void add(double x, double y) {
    if (is_started_ && std::floor(x * 2) == column_) {
      low_ = std::min(low_, y);
      high_ = std::max(high_, y);
      last_x_ = x;
      last_ = y;
      has_more_ = true;
      return;
    }
    flush();
    emit(is_started_ ? 'L' : 'M', x, y);
    column_ = std::floor(x * 2);
    low_ = high_ = last_ = first_ = y;
    is_started_ = true;
  }
  void lift() {
    flush();
    is_started_ = false;
  }
  [[nodiscard]] std::string take() {
    flush();
    return std::move(commands_);
  }

 private:
  void flush() {
    if (!has_more_) {
      return;
    }
    has_more_ = false;
    if (low_ < std::min(first_, last_)) {
      emit('L', last_x_, low_);
    }
    if (high_ > std::max(first_, last_)) {
      emit('L', last_x_, high_);
    }
    emit('L', last_x_, last_);
  }
  void emit(char command, double x, double y) { commands_ += fmt::format("{}{:.1f} {:.1f}", command, x, y); }

  std::string commands_;
  double column_ = 0, low_ = 0, high_ = 0, first_ = 0, last_ = 0, last_x_ = 0;
  bool is_started_ = false;
  bool has_more_ = false;
};

std::string line_commands(const Series& series, const Frame2d& frame) {
  ThinnedPath path;
  double held = 0;
  bool is_down = false;
  for (std::size_t k = 0; k < std::min(series.x.size(), series.y.size()); ++k) {
    if (!std::isfinite(series.x[k]) || !std::isfinite(series.y[k])) {
      path.lift();
      is_down = false;
      continue;
    }
    // Far outside the plot a coordinate says nothing more and only overflows renderers.
    const double x = std::clamp(frame.px(series.x[k]), -1e4, 1e4);
    const double y = std::clamp(frame.py(series.y[k]), -1e4, 1e4);
    if (series.kind == SeriesKind::Step && is_down) {
      path.add(x, held);
    }
    path.add(x, y);
    held = y;
    is_down = true;
  }
  return path.take();
}

std::string point_commands(const Series& series, const Frame2d& frame) {
  std::string commands;
  for (std::size_t k = 0; k < std::min(series.x.size(), series.y.size()); ++k) {
    if (std::isfinite(series.x[k]) && std::isfinite(series.y[k])) {
      commands += fmt::format("M{:.1f} {:.1f}h0", frame.px(series.x[k]), frame.py(series.y[k]));
    }
  }
  return commands;
}

std::string bar_commands(const Series& series, const Frame2d& frame) {
  std::string commands;
  const std::size_t n = std::min(series.x.size(), series.y.size());
  for (std::size_t k = 0; k < n; ++k) {
    const double next = k + 1 < n ? series.x[k + 1] : n > 1 ? 2 * series.x[k] - series.x[k - 1] : series.x[k] + 1;
    const double top = frame.py(series.y[k]);
    const double bottom = frame.py(0);
    if (bottom - top > 0.05) {
      commands += fmt::format("M{:.1f} {:.1f}V{:.1f}H{:.1f}V{:.1f}Z", frame.px(series.x[k]), bottom, top,
                              frame.px(next), bottom);
    }
  }
  return commands;
}

void draw_series(SvgBody& svg, const Series& series, const Frame2d& frame) {
  const std::string name =
      series.name.empty() ? std::string() : fmt::format(" data-name=\"{}\"", xml_escape(series.name));
  const std::string opacity = series.opacity < 1 ? fmt::format(" opacity=\"{}\"", coordinate(series.opacity)) : "";
  switch (series.kind) {
    case SeriesKind::Line:
    case SeriesKind::Step:
      svg.path(line_commands(series, frame), "ln s-" + series.ink + (series.is_dashed ? " dash" : ""),
               fmt::format("stroke-width=\"{}\"{}{}", coordinate(series.width_px), opacity, name));
      break;
    case SeriesKind::Points:
      svg.path(point_commands(series, frame), "ln s-" + series.ink,
               fmt::format("stroke-width=\"{}\"{}", coordinate(series.width_px), opacity));
      break;
    case SeriesKind::Bars:
      svg.path(bar_commands(series, frame), "f-" + series.ink, opacity);
      break;
  }
}

Frame2d lay_out_plot(const Chart& chart, const Box& box, int legend_lines) {
  Frame2d frame;
  const double top = box.y + legend_lines * kLegendLinePx + 4;
  frame.plot = {box.x, top, box.width, std::max(20.0, box.y + box.height - kBottomMarginPx - top)};
  frame.y = axis_range(chart.y, data_range(chart.series, false), std::max(2, static_cast<int>(frame.plot.height / 38)));
  const Ticks ticks = ticks_of(frame.y);
  double label_px = 0;
  for (int k = 0; k < ticks.count; ++k) {
    label_px = std::max(label_px, text_width_px(number_text(ticks.first + k * ticks.step, ticks.decimals), kFontPx));
  }
  const double left = std::max(30.0, label_px + 10);
  frame.plot.x = box.x + left;
  frame.plot.width = std::max(20.0, box.width - left - kRightMarginPx);
  frame.x = axis_range(chart.x, data_range(chart.series, true), std::max(2, static_cast<int>(frame.plot.width / 80)));
  if (chart.has_equal_scales) {
    equalise(frame);
    const double step =
        nice_ticks(frame.x.low, frame.x.high, std::max(2, static_cast<int>(frame.plot.width / 80))).step;
    frame.x.step = frame.y.step = step;
  }
  return frame;
}

/// What the page's script needs to turn pixels back into values.
std::string cursor_attributes(const Frame2d& frame) {
  return fmt::format("<g class=\"plot\" data-x=\"{} {} {} {}\" data-y=\"{} {} {} {}\"/>", frame.x.low, frame.x.high,
                     coordinate(frame.plot.x), coordinate(frame.plot.x + frame.plot.width), frame.y.low, frame.y.high,
                     coordinate(frame.plot.y + frame.plot.height), coordinate(frame.plot.y));
}

}  // namespace

Ticks nice_ticks(double low, double high, int count) {
  Ticks ticks;
  if (!std::isfinite(low) || !std::isfinite(high) || !(high > low) || count < 1) {
    return ticks;
  }
  const double rough = (high - low) / count;
  const double magnitude = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / magnitude;
  const double step = (share <= 1.0001 ? 1 : share <= 2.0001 ? 2 : share <= 5.0001 ? 5 : 10) * magnitude;
  return multiples_of(step, low, high);
}

void draw_chart(SvgBody& svg, const Chart& chart, const Box& box) {
  std::vector<LegendEntry> entries;
  const int legend_lines = lay_out_legend(chart, box, entries);
  const Frame2d frame = lay_out_plot(chart, box, legend_lines);
  svg.text(box.x, box.y + 12, chart.y.label, "f-muted");
  draw_legend(svg, entries, box.y);
  for (const Shade& shade : chart.shades) {
    const double x0 = std::clamp(frame.px(shade.begin), frame.plot.x, frame.plot.x + frame.plot.width);
    const double x1 = std::clamp(frame.px(shade.end), frame.plot.x, frame.plot.x + frame.plot.width);
    svg.rect({x0, frame.plot.y, x1 - x0, frame.plot.height}, "f-muted", 0.14);
  }
  draw_axes(svg, chart, frame);
  svg.begin_clip(frame.plot);
  for (const double mark : chart.marks) {
    svg.line(frame.px(mark), frame.plot.y, frame.px(mark), frame.plot.y + frame.plot.height, "hair s-grid");
  }
  for (const Series& series : chart.series) {
    draw_series(svg, series, frame);
  }
  svg.end_clip();
  if (chart.has_cursor) {
    svg.raw(cursor_attributes(frame));
  }
}

std::string chart_svg(const Chart& chart, double width, double height, const std::string& css) {
  SvgBody svg;
  draw_chart(svg, chart, {0, 0, width, height});
  return inline_svg(svg, width, height, css + (chart.has_cursor ? " chart cursor" : " chart"), chart.description);
}

std::string responsive_chart(const Chart& chart, double height) {
  return chart_svg(chart, kWidePx, height, "wide") + chart_svg(chart, kNarrowPx, height, "narrow");
}

}  // namespace tectum
