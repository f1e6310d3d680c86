#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "drivers/head/ax12_plant.h"

using namespace tectum;

namespace {

constexpr TimeNs kMs = 1'000'000;
constexpr double kUnitDeg = 300.0 / 1023.0;

Ax12Params fixed_dead_time(double seconds) {
  Ax12Params params;
  params.dead_time_drawn = false;
  params.fixed_dead_time_s = seconds;
  return params;
}

// The shaft at each millisecond after a goal given at 0.
std::vector<double> step_response(const Ax12Params& params, double goal_deg, int duration_ms,
                                  JointLimits limits = {-50, 50}) {
  Ax12Plant plant(params, limits, 1, 0);
  plant.command(0, goal_deg, true);
  std::vector<double> position_deg;
  for (int ms = 0; ms <= duration_ms; ++ms) {
    plant.advance_to(ms * kMs);
    position_deg.push_back(plant.position_deg(ms * kMs));
  }
  return position_deg;
}

}  // namespace

TEST_CASE("the shaft does not move before the dead time is over and moves right after") {
  const auto position_deg = step_response(fixed_dead_time(0.030), 20, 60);
  CHECK(position_deg[29] == 0);
  CHECK(position_deg[31] > 0);
}

TEST_CASE("dead times are drawn within the measured range, one for each servo, the same for the same seed") {
  std::set<double> seen;
  for (std::uint32_t servo = 0; servo < kJointCount; ++servo) {
    const Ax12Plant plant({}, {-50, 50}, 7, servo);
    CHECK(plant.dead_time_s() >= 0.017);
    CHECK(plant.dead_time_s() <= 0.050);
    CHECK(plant.dead_time_s() == Ax12Plant({}, {-50, 50}, 7, servo).dead_time_s());
    seen.insert(plant.dead_time_s());
  }
  CHECK(seen.size() == kJointCount);
  CHECK(Ax12Plant({}, {-50, 50}, 7, 0).dead_time_s() != Ax12Plant({}, {-50, 50}, 8, 0).dead_time_s());
}

TEST_CASE("the slew never exceeds the no-load speed, nor a lower moving speed") {
  for (const double moving_speed_deg_s : {0.0, 114.6, 1000.0}) {
    CAPTURE(moving_speed_deg_s);
    Ax12Params params = fixed_dead_time(0.020);
    params.moving_speed_deg_s = moving_speed_deg_s;
    const double top_deg_s = moving_speed_deg_s == 114.6 ? 114.6 : 354.0;
    const auto position_deg = step_response(params, 45, 500);
    double fastest_deg_s = 0;
    for (std::size_t i = 1; i < position_deg.size(); ++i) {
      fastest_deg_s = std::max(fastest_deg_s, (position_deg[i] - position_deg[i - 1]) * 1000);
    }
    CHECK(fastest_deg_s <= top_deg_s + 1e-9);
    CHECK(fastest_deg_s > 0.9 * top_deg_s);
  }
}

TEST_CASE("the shaft settles within the compliance margin of the goal in whole units") {
  for (const double goal_deg : {0.9, 3.0, -12.34, 27.5, -44.0}) {
    CAPTURE(goal_deg);
    const auto position_deg = step_response(fixed_dead_time(0.030), goal_deg, 1500);
    const double goal_in_units_deg = std::round(goal_deg / kUnitDeg) * kUnitDeg;
    CHECK(std::abs(position_deg.back() - goal_in_units_deg) <= kUnitDeg + 1e-9);
    CHECK(position_deg[1500] == doctest::Approx(position_deg[1400]).epsilon(1e-4));
  }
}

TEST_CASE("a change of goal under half a unit does nothing, nor does one within the margin") {
  CHECK(step_response(fixed_dead_time(0.020), 0.14, 500).back() == 0);
  CHECK(step_response(fixed_dead_time(0.020), 0.29, 500).back() == 0);
  CHECK(step_response(fixed_dead_time(0.020), 0.60, 500).back() > 0);
}

TEST_CASE("a 15 degree step is over within 200 ms of the command and overshoots by less than a tenth") {
  const auto position_deg = step_response(fixed_dead_time(0.030), 15, 600);
  CHECK(std::abs(position_deg[200] - 15) < 0.6);
  CHECK(*std::max_element(position_deg.begin(), position_deg.end()) < 16.5);
}

TEST_CASE("the shaft stops at the mechanical limit") {
  const auto position_deg = step_response(fixed_dead_time(0.020), 80, 800, {-10, 20});
  CHECK(*std::max_element(position_deg.begin(), position_deg.end()) <= 20);
  CHECK(position_deg.back() > 19.3);
}

TEST_CASE("commands are carried out in order, each after the dead time") {
  Ax12Plant plant(fixed_dead_time(0.040), {-50, 50}, 1, 0);
  plant.command(0, 20, true);
  plant.command(22 * kMs, -20, true);
  plant.advance_to(60 * kMs);
  CHECK(plant.position_deg(60 * kMs) > 0);
  plant.advance_to(1000 * kMs);
  CHECK(plant.position_deg(1000 * kMs) < -19);
}

TEST_CASE("torque off leaves the shaft where it coasts to") {
  Ax12Plant plant(fixed_dead_time(0.020), {-50, 50}, 1, 0);
  plant.command(0, 40, true);
  plant.command(60 * kMs, 40, false);
  plant.advance_to(1000 * kMs);
  const double rest_deg = plant.position_deg(1000 * kMs);
  CHECK(rest_deg > 5);
  CHECK(rest_deg < 35);
}

TEST_CASE("a goal that is no number is ignored") {
  Ax12Plant plant(fixed_dead_time(0.020), {-50, 50}, 1, 0);
  plant.command(0, std::numeric_limits<double>::quiet_NaN(), true);
  plant.advance_to(100 * kMs);
  CHECK(plant.position_deg(100 * kMs) == 0);
}

TEST_CASE("the path does not depend on how often the world looks") {
  Ax12Plant often({}, {-50, 50}, 3, 2);
  Ax12Plant seldom({}, {-50, 50}, 3, 2);
  often.command(0, 17, true);
  seldom.command(0, 17, true);
  for (TimeNs now_ns = 0; now_ns <= 90 * kMs; now_ns += 300'000) {
    often.advance_to(now_ns);
  }
  seldom.advance_to(90 * kMs);
  CHECK(often.position_deg(90 * kMs) == seldom.position_deg(90 * kMs));
  CHECK(std::remainder(seldom.measured_deg(90 * kMs), kUnitDeg) == doctest::Approx(0));
}
