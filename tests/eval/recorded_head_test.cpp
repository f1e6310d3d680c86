#include "tools/evaluate/recorded_head.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/eval/evaluated_circuit.h"
#include "tools/evaluate/evaluation_report.h"
#include "tools/evaluate/evaluation_text.h"
#include "tools/evaluate/step_chart.h"

using namespace tectum;

namespace {

constexpr const char* kHeader = "t_s,laser_x_m,laser_z_m,left_x_m,left_z_m,right_x_m,right_z_m\n";
constexpr double kHoldS = 2;

/// 20 Hz, four holds: the laser up and down by `extent_m` about a height of 1 m; both eyes look where `eye` says, as a
/// share of the way to the laser's place from the last one, by the time since the jump.
std::string file_of(
    double extent_m, const std::function<double(double)>& eye,
    const std::function<double(double)>& laser = [](double) { return 1.0; }) {
  std::string text = kHeader;
  for (int k = 0; k < 160; ++k) {
    const double time_s = 0.05 * k;
    const int hold = k / 40;
    const double since_s = time_s - kHoldS * hold;
    const double from_m = hold % 2 == 0 ? extent_m : -extent_m, to_m = -from_m;
    const auto at = [&](double share) { return 1 + (hold == 0 ? to_m : from_m + share * (to_m - from_m)); };
    text += fmt::format("{:.2f},0,{:.6f},0,{:.6f},0,{:.6f}\n", time_s, at(laser(since_s)), at(eye(since_s)),
                        at(eye(since_s)));
  }
  return text;
}

double overshooting(double since_s) { return since_s < 0.19 ? 0 : since_s < 0.39 ? 1.25 : 1; }

}  // namespace

TEST_CASE("a recorded head's steps are measured as the simulated head's are") {
  const ReadRecordedHead read = read_recorded_text("head.csv", file_of(10, overshooting), 100);  // 11.4 deg each
  REQUIRE(read.error == "");
  const StepSummary& steps = read.head->result.steps;
  CHECK(steps.steps == 6);
  CHECK(steps.settled == 6);
  CHECK(steps.median_latency_s == doctest::Approx(0.2));
  // Up to 15 m: 2.8 deg beyond, so that only the return is within 2 deg.
  CHECK(steps.median_overshoot_share == doctest::Approx((std::atan(0.15) - std::atan(0.1)) / (2 * std::atan(0.1))));
  CHECK(steps.median_settled_s == doctest::Approx(0.4));
}

TEST_CASE("its RMSE is that of the laser's angle about the middle of its resting places") {
  const std::string still = file_of(0.2, [](double) { return 0.5; });
  std::string text = kHeader;  // the first hold too
  for (std::size_t at = still.find('\n') + 1; at < still.size(); at = still.find('\n', at) + 1) {
    const std::string line = still.substr(at, still.find('\n', at) - at);
    const std::string laser = line.substr(0, line.find(',', line.find(',', line.find(',') + 1) + 1));
    text += laser + ",-0.06,1,0.06,1\n";
  }
  const ReadRecordedHead read = read_recorded_text("head.csv", text, 0.5865);
  REQUIRE(read.error == "");
  const auto& channels = read.head->result.channels;
  const double tilt_deg = std::atan2(0.2, 0.5865) * 180 / std::numbers::pi;
  CHECK(channels[1].wall_rmse_deg == doctest::Approx(tilt_deg));
  // Straight ahead of each eye, 0.06 m from the laser's x.
  CHECK(channels[0].rmse_deg == doctest::Approx(std::atan2(0.06, 0.5815) * 180 / std::numbers::pi).epsilon(0.001));
  CHECK(channels[0].median_deg > 0);  // the laser is to the right of the left eye's axis
  CHECK(channels[2].median_deg < 0);
  CHECK(read.head->result.trials.front().steps.settled == 0);
}

TEST_CASE("a laser that takes three frames for its way and overshoots jumps once, and its true place counts") {
  const auto laser = [](double since_s) { return since_s < 0.04 ? 0.4 : since_s < 0.09 ? 1.2 : 1.0; };
  const ReadRecordedHead slow = read_recorded_text("head.csv", file_of(5, overshooting, laser), 100);
  const ReadRecordedHead sudden = read_recorded_text("head.csv", file_of(5, overshooting), 100);
  REQUIRE(slow.head);
  CHECK(slow.head->result.steps.steps == 6);
  CHECK(slow.head->result.steps.median_overshoot_share ==
        doctest::Approx(sudden.head->result.steps.median_overshoot_share));
  CHECK(slow.head->result.channels[1].rmse_deg != sudden.head->result.channels[1].rmse_deg);
  CHECK(slow.head->result.channels[1].wall_rmse_deg != sudden.head->result.channels[1].wall_rmse_deg);
}

TEST_CASE("an eye on the laser in every frame has no error by either definition") {
  const ReadRecordedHead read = read_recorded_text("head.csv", file_of(0.2, [](double) { return 1.0; }), 0.5865);
  REQUIRE(read.head);
  CHECK(read.head->result.all.rmse_deg < 1e-6);
  CHECK(read.head->result.all.wall_rmse_deg < 1e-6);
}

TEST_CASE("the columns may stand in any order among others, with the line ends of either kind") {
  const std::string plain = file_of(0.2, overshooting);
  std::string other = "note,right_z_m,right_x_m,left_z_m,left_x_m,laser_z_m,laser_x_m,t_s\r\n";
  for (std::size_t at = plain.find('\n') + 1; at < plain.size(); at = plain.find('\n', at) + 1) {
    std::string line = plain.substr(at, plain.find('\n', at) - at);
    std::string reversed = "x";
    for (std::size_t comma = line.rfind(','); comma != std::string::npos; comma = line.rfind(',')) {
      reversed += "," + line.substr(comma + 1);
      line.resize(comma);
    }
    other += reversed + ", " + line + "\r\n";
  }
  const ReadRecordedHead a = read_recorded_text("head.csv", plain, 0.5865);
  const ReadRecordedHead b = read_recorded_text("head.csv", other + "\r\n", 0.5865);
  REQUIRE(a.head);
  REQUIRE(b.error == "");
  CHECK(a.head->result.all.rmse_deg == b.head->result.all.rmse_deg);
}

TEST_CASE("what is wrong in the file is told with its line and column") {
  const std::string header = kHeader;
  const std::pair<std::string, std::string> cases[] = {
      {"", "head.csv: is empty"},
      {header, "head.csv: holds no rows"},
      {"t_s,laser_x_m\n0,0\n", "head.csv:1: no column `laser_z_m` among `t_s`, `laser_x_m`"},
      {header + "0,0,0,0,0,0,0\n0.05,0,0,far,0,0,0\n", "head.csv:3: `left_x_m` is `far`, which is no number"},
      {header + "0,0,0,nan,0,0,0\n", "head.csv:2: `left_x_m` is `nan`, which is no number"},
      {header + "0,0,0,1e999,0,0,0\n", "head.csv:2: `left_x_m` is `1e999`, which is no number"},
      {header + "0,0,0\n", "head.csv:2: 3 cells, none for `left_x_m`"},
      {header + "0.1,0,0,0,0,0,0\n\n0.1,0,0,0,0,0,0\n", "head.csv:4: `t_s` is 0.1 after 0.1 in the line before"},
      {header + "0,0,0,0,0,0,0\n",
       "head.csv: the laser never jumps in its 1 rows (by 0.02 m or more, 1 s after the start)"},
  };
  for (const auto& [bytes, error] : cases) {
    CAPTURE(bytes);
    const ReadRecordedHead read = read_recorded_text("head.csv", bytes, 0.5865);
    CHECK_FALSE(read.head);
    CHECK(read.error == error);
  }
  CHECK(read_recorded_head("no/such/head.csv", 0.5865).error == "cannot read no/such/head.csv");
}

TEST_CASE("the course after a jump is the median share of the way, and stands in table, JSON and page") {
  const ReadRecordedHead read = read_recorded_text("head.csv", file_of(0.2, overshooting), 0.5865);
  REQUIRE(read.head);
  const std::vector<double> course = median_course(read.head->result.first_trial, 1);
  REQUIRE(course.size() == 21);
  CHECK(course[3] == doctest::Approx(0));
  CHECK(course[5] > 1.15);
  CHECK(course[10] == doctest::Approx(1));

  Protocol protocol = shipped_protocol("step");
  protocol.trials = 1;
  protocol.duration_s = 6;
  const TrackingEvaluation evaluation = evaluate_tracking(oculomotor_image(), protocol, 2, nullptr);
  const std::vector<CircuitEvaluation> circuits = {{"c", evaluation}};
  const RecordedHead* recorded = &*read.head;
  CHECK(tracking_text(protocol, circuits, recorded).find("\n  recorded ") != std::string::npos);
  CHECK(tracking_text(protocol, circuits, recorded).find("recorded: head.csv, 160 frames") != std::string::npos);
  CHECK(tracking_text(protocol, circuits).find("\n  recorded ") == std::string::npos);
  CHECK(tracking_json(protocol, "c", evaluation, recorded).find("\"recorded\": {") != std::string::npos);
  CHECK(tracking_json(protocol, "c", evaluation).find("\"recorded\"") == std::string::npos);
  CHECK(tracking_report({"c", ""}, protocol, evaluation, recorded).find("beside the recorded head") !=
        std::string::npos);
}
