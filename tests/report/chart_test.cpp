#include "tools/report/chart.h"

#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/report/well_formed.h"

namespace tectum {
namespace {

TEST_CASE("ticks are multiples of 1, 2 or 5 and need no more decimals than their step") {
  struct Case {
    double low, high;
    int count;
    double first, step;
    int ticks, decimals;
  };
  for (const Case& c : {Case{0, 60, 6, 0, 10, 7, 0}, Case{-13, 27, 4, -10, 10, 4, 0}, Case{0, 1, 5, 0, 0.2, 6, 1},
                        Case{0.01, 0.09, 4, 0.02, 0.02, 4, 2}, Case{-40, 40, 3, 0, 50, 1, 0}}) {
    CAPTURE(c.low);
    const Ticks ticks = nice_ticks(c.low, c.high, c.count);
    CHECK(ticks.first == doctest::Approx(c.first));
    CHECK(ticks.step == doctest::Approx(c.step));
    CHECK(ticks.count == c.ticks);
    CHECK(ticks.decimals == c.decimals);
  }
}

TEST_CASE("an empty or senseless range has no ticks") {
  CHECK(nice_ticks(1, 1, 5).count == 0);
  CHECK(nice_ticks(0, std::numeric_limits<double>::infinity(), 5).count == 0);
  CHECK(nice_ticks(std::nan(""), 1, 5).count == 0);
}

TEST_CASE("a value that is not finite breaks the line and reaches no coordinate") {
  Chart chart;
  const double inf = std::numeric_limits<double>::infinity();
  chart.series.push_back({SeriesKind::Line, "a", "left", {0, 1, 2, 3, 4}, {0, 1, std::nan(""), inf, 2}, 1, 1, false});
  const std::string svg = chart_svg(chart, 400, 200, "x");
  CHECK(first_markup_error(svg) == "");
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(svg.find("inf") == std::string::npos);
  const std::size_t d = svg.find("d=\"M", svg.find("s-left\" d", svg.find("viewBox", 60)));
  const std::string line = svg.substr(d, svg.find('"', d + 3) - d);
  CHECK(std::count(line.begin(), line.end(), 'M') == 2);
}

TEST_CASE("a line of a million points is thinned to the pixels, extremes kept") {
  Chart chart;
  Series series{SeriesKind::Line, "a", "left", {}, {}, 1, 1, false};
  for (int k = 0; k < 1'000'000; ++k) {
    series.x.push_back(k);
    series.y.push_back(k == 612'345 ? 50 : std::sin(k * 0.1));
  }
  chart.series.push_back(std::move(series));
  chart.y.max = 50;
  const std::string svg = chart_svg(chart, 400, 200, "x");
  CHECK(svg.size() < 60'000);
  // The spike of a single sample still reaches the top of the plot, 22 px down.
  CHECK(svg.find(" 22.0L") != std::string::npos);
}

TEST_CASE("a chart without data has axes and no crash") {
  CHECK(first_markup_error(responsive_chart(Chart{}, 100)) == "");
}

TEST_CASE("numbers for people carry a real minus and no negative zero") {
  CHECK(number_text(-1.25, 1) == "−1.2");
  CHECK(number_text(-0.001, 2) == "0.00");
  CHECK(number_text(std::nan(""), 2) == "–");
  CHECK(count_text(1234567) == "1\u2009234\u2009567");
  CHECK(count_text(12) == "12");
  CHECK(coordinate(1.5) == "1.5");
  CHECK(coordinate(-0.001) == "0");
}

TEST_CASE("text is cut between characters, not inside one") {
  CHECK(fit_text("ααααααααααα", 40) == "αααα…");
  CHECK(fit_text("short", 400) == "short");
}

TEST_CASE("text that goes into a page loses its markup and its control characters") {
  CHECK(xml_escape("<a&\"\x02>") == "&lt;a&amp;&quot;&gt;");
}

}  // namespace
}  // namespace tectum
