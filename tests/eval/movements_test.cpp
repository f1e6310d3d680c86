#include "tools/evaluate/movements.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/eval/evaluated_circuit.h"
#include "tools/evaluate/evaluation_report.h"
#include "tools/evaluate/movement_trial.h"

using namespace tectum;

namespace {

/// A column's value in the first table's row.
double value(const MeasuredProtocol& measured, std::size_t row, const std::string& column) {
  const MeasureTable& table = measured.tables.at(0);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (table.columns[c].name == column) {
      REQUIRE(table.rows.at(row).values[c].has_value());
      return *table.rows[row].values[c];
    }
  }
  FAIL("no column ", column);
  return 0;
}

Protocol short_protocol(const std::string& name) {
  Protocol protocol = shipped_protocol(name);
  protocol.trials = 1;
  return protocol;
}

MeasuredProtocol measure(const Protocol& protocol, unsigned threads = 0) {
  return measure_movements(oculomotor_image(), protocol, threads, nullptr);
}

}  // namespace

TEST_CASE("a step of 10 deg in view is answered in every direction and leaves little over") {
  Protocol protocol = short_protocol("saccades");
  protocol.movement.sizes_deg = {10};
  const MeasuredProtocol measured = measure(protocol);
  REQUIRE(measured.tables.at(0).rows.size() == 1);
  CHECK(value(measured, 0, "steps") == 8);
  CHECK(value(measured, 0, "with a saccade") == 100);
  CHECK(value(measured, 0, "off direction") < 15);
  CHECK(value(measured, 0, "left over") < 2);
  // A servo's shaft cannot turn faster than 354 deg/s on each of two axes.
  CHECK(value(measured, 0, "servo peak") < 354 * 1.42);
}

TEST_CASE("the demand on vergence is what the geometry of eyes and screen says") {
  Protocol protocol = short_protocol("vergence");
  protocol.movement.distances_m = {0.3};
  const MeasuredProtocol measured = measure(protocol);
  constexpr double kDegPerRad = 57.29577951;
  // Eyes 6 cm to either side and 5 mm before the origin, level with the dot.
  const double demand_deg = 2 * kDegPerRad * (std::atan(0.06 / 0.295) - std::atan(0.06 / 0.545));
  CHECK(std::abs(value(measured, 0, "demand") - demand_deg) < 0.3);
  CHECK(std::abs(value(measured, 1, "demand") + demand_deg) < 0.3);
}

TEST_CASE("a slow dot is followed, and the oracle's error is the least") {
  Protocol protocol = short_protocol("pursuit");
  protocol.movement.speeds_deg_s = {5};
  protocol.movement.periods_s = {};
  const MeasuredProtocol measured = measure(protocol);
  CHECK(value(measured, 0, "gain") > 0.5);
  CHECK(value(measured, 0, "gain") < 1.5);
  CHECK(value(measured, 0, "oracle") < value(measured, 0, "RMSE"));
}

TEST_CASE("the neck stays out of a small gaze shift and joins a large one") {
  Protocol protocol = short_protocol("gaze");
  protocol.movement.sizes_deg = {10, 40};
  const MeasuredProtocol measured = measure(protocol);
  REQUIRE(measured.tables.at(0).rows.size() == 4);
  CHECK(std::abs(value(measured, 0, "neck")) < 2);
  CHECK(value(measured, 1, "neck") > 5);
}

TEST_CASE("a dot that reaches beyond the fovea is looked at with microsaccades, and one inside it without") {
  Protocol protocol = short_protocol("fixation");
  protocol.duration_s = 20;
  protocol.movement.radii_m = {0.006, 0.015};
  const MeasuredProtocol measured = measure(protocol);
  CHECK(value(measured, 0, "by velocity") == 0);
  CHECK(value(measured, 1, "by velocity") > 0.3);
  CHECK(value(measured, 1, "by velocity") < 3);
  CHECK(value(measured, 1, "amplitude") < 1);
  REQUIRE(measured.tables.size() == 2);
  CHECK(measured.tables[1].rows.size() == 6);
}

TEST_CASE("a protocol that names no fovea gives no verdict on fixation") {
  Protocol protocol = short_protocol("fixation");
  protocol.duration_s = 4;
  protocol.movement.radii_m = {0.0022};
  protocol.movement.fovea_deg = 0;
  CHECK(measure(protocol).tables.size() == 1);
}

TEST_CASE("movements are the same for any number of threads") {
  Protocol protocol = short_protocol("fixation");
  protocol.trials = 2;
  protocol.duration_s = 6;
  protocol.movement.radii_m = {0.0022};
  const MeasuredProtocol one = measure(protocol, 1);
  CHECK(measures_json("p", "c", one.tables) == measures_json("p", "c", measure(protocol, 2).tables));
}

TEST_CASE("places are where the head's origin sees them") {
  const std::array<double, 2> place = place_m(30, 20, 0.5);
  CHECK(place[0] == doctest::Approx(0.5 * std::tan(30 / 57.29577951)));
  CHECK(std::atan2(place[1], std::hypot(0.5, place[0])) * 57.29577951 == doctest::Approx(20));
}

TEST_CASE("a table's columns stand under their names, and what is not measurable is a dash") {
  const MeasureTable table{"title", {{"gain", "", 2}, {"latency", "ms", 0}}, {{"5 deg", {0.951, {}}}}, {"a note"}};
  CHECK(measures_text({table}) ==
        "\ntitle\n"
        "              gain    latency\n"
        "                           ms\n"
        "  5 deg       0.95          -\n"
        "a note\n");
}

TEST_CASE("a report holds every table's rows and every picture") {
  Protocol protocol;
  protocol.name = "p";
  MeasuredProtocol measured;
  measured.tables = {{"title", {{"gain", "", 2}}, {{"row <1>", {0.5}}}, {}}};
  Chart chart;
  chart.series.push_back({.kind = SeriesKind::Line, .name = "eye", .ink = "left", .x = {0, 1}, .y = {0, 1}});
  measured.pictures = {{"picture one", "", chart}};
  const std::string html = measures_report({"c", "tectum eval"}, protocol, measured);
  CHECK(html.find("row\u00a0&lt;1&gt;") != std::string::npos);
  CHECK(html.find("picture one") != std::string::npos);
  CHECK(html.find("<svg") != std::string::npos);
}
