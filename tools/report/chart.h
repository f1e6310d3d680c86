// Charts with axes: lines, steps, points and bars.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/svg.h"

namespace tectum {

enum class SeriesKind {
  Line,
  Step,  // holds each value until the next sample
  Points,
  Bars,  // from 0; x is the left edge of a bar that reaches to the next x (the last as wide as the one before)
};

struct Series {
  SeriesKind kind = SeriesKind::Line;
  std::string name;  // in the legend; empty: not listed
  std::string ink;   // a role of tools/report/theme.h
  std::vector<double> x;
  std::vector<double> y;  // a value that is not finite breaks the line
  double width_px = 1.6;
  double opacity = 1;
  bool is_dashed = false;
};

struct ChartAxis {
  std::string label;               // with its unit: "time (s)"
  std::optional<double> min, max;  // by default the data's, rounded outwards to a tick
  double min_span = 0;             // a flat trace is not blown up beyond this
};

/// A range of x to set off, such as the part that another chart enlarges.
struct Shade {
  double begin = 0, end = 0;
};

struct Chart {
  std::string description;  // for those who cannot see it
  ChartAxis x;
  ChartAxis y;
  std::vector<Series> series;
  std::vector<Shade> shades;
  std::vector<double> marks;      // thin vertical lines, e.g. target jumps
  bool has_equal_scales = false;  // one degree is as long across as it is up
  bool has_cursor = false;        // pages show values under the pointer, in step with other such charts
};

/// Multiples of 1, 2 or 5 times a power of ten in [low, high], about `count` of them.
struct Ticks {
  double first = 0;
  double step = 1;
  int count = 0;
  int decimals = 0;
};
[[nodiscard]] Ticks nice_ticks(double low, double high, int count);

/// Draws the chart, legend and labels included, into the box.
void draw_chart(SvgBody&, const Chart&, const Box&);

/// One <svg> for a page.
[[nodiscard]] std::string chart_svg(const Chart&, double width, double height, const std::string& css);

/// Two of them, of which the page shows the one that suits its width, so that type stays readable on a phone.
[[nodiscard]] std::string responsive_chart(const Chart&, double height);

inline constexpr double kWidePx = 1000;
inline constexpr double kNarrowPx = 400;

}  // namespace tectum
