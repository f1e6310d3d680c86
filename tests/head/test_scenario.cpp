#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "drivers/head/scenario.h"

using namespace tectum;

namespace {

constexpr TimeNs kSecond = 1'000'000'000;

ScenarioParams of_kind(ScenarioKind kind) {
  ScenarioParams params;
  params.kind = kind;
  return params;
}

double pan_deg(const std::array<double, 2>& point, double wall_m) {
  return std::atan2(point[0], wall_m) * 180 / std::numbers::pi;
}

}  // namespace

TEST_CASE("every scenario's name parses back to it, and no other does") {
  for (const char* name : kScenarioNames) {
    const auto kind = scenario_from_name(name);
    REQUIRE(kind.has_value());
    CHECK(std::string_view(scenario_name(*kind)) == name);
  }
  CHECK_FALSE(scenario_from_name("Random").has_value());
  CHECK_FALSE(scenario_from_name("").has_value());
}

TEST_CASE("step visits the eight points of the recorded experiment, four seconds each, and starts over") {
  Scenario scenario(of_kind(ScenarioKind::Step));
  const double r = ScenarioParams{}.extent_m;
  CHECK(scenario.target_m(0) == std::array{r, -r});
  CHECK(scenario.target_m(4 * kSecond - 1) == std::array{r, -r});
  CHECK(scenario.target_m(4 * kSecond) == std::array{r, 0.0});
  CHECK(scenario.target_m(12 * kSecond) == std::array{0.0, 0.0});
  CHECK(scenario.target_m(31 * kSecond) == std::array{0.0, -r});
  CHECK(scenario.target_m(32 * kSecond) == std::array{r, -r});
}

TEST_CASE("circle keeps its radius and comes round in its period") {
  Scenario scenario(of_kind(ScenarioKind::Circle));
  const double r = ScenarioParams{}.extent_m;
  for (TimeNs t = 0; t < 20 * kSecond; t += 333'000'000) {
    const auto p = scenario.target_m(t);
    CHECK(std::hypot(p[0], p[1]) == doctest::Approx(r));
  }
  CHECK(scenario.target_m(0)[1] == doctest::Approx(-r));
  CHECK(scenario.target_m(5 * kSecond)[1] == doctest::Approx(r));
  CHECK(scenario.target_m(2'500'000'000)[0] == doctest::Approx(r));
}

TEST_CASE("chirp speeds up from a turn in 20 s to a turn in about a second and never jumps") {
  Scenario scenario(of_kind(ScenarioKind::Chirp));
  CHECK(scenario.target_m(10 * kSecond)[1] == doctest::Approx(ScenarioParams{}.extent_m));
  double slowest_m = 1, fastest_m = 0;
  auto last = scenario.target_m(0);
  for (TimeNs t = 10'000'000; t < 120 * kSecond; t += 10'000'000) {
    const auto p = scenario.target_m(t);
    const double moved_m = std::hypot(p[0] - last[0], p[1] - last[1]);
    slowest_m = std::min(slowest_m, moved_m);
    fastest_m = std::max(fastest_m, moved_m);
    last = p;
  }
  const double turn_m = 2 * std::numbers::pi * ScenarioParams{}.extent_m;
  CHECK(slowest_m == doctest::Approx(turn_m * 0.01 / 20).epsilon(0.01));
  CHECK(fastest_m > turn_m * 0.01 / 1.2);
  CHECK(fastest_m < turn_m * 0.01 / 0.99);
}

TEST_CASE("random starts ahead, stays in its range, jumps no farther than allowed, holds for its time") {
  ScenarioParams params = of_kind(ScenarioKind::Random);
  Scenario scenario(params);
  CHECK(scenario.target_m(0) == std::array{0.0, 0.0});
  std::set<double> places;
  auto last = scenario.target_m(0);
  double farthest_right = 0, farthest_left = 0;
  for (int second = 1; second < 600; ++second) {
    const auto p = scenario.target_m(second * kSecond);
    CHECK(p == scenario.target_m(second * kSecond + 999'000'000));
    CHECK(std::abs(pan_deg(p, 0.55)) <= 25);
    CHECK(std::abs(pan_deg({p[1], 0}, 0.55)) <= 15);
    const double cosine = (p[0] * last[0] + p[1] * last[1] + 0.55 * 0.55) /
                          (std::hypot(p[0], p[1], 0.55) * std::hypot(last[0], last[1], 0.55));
    CHECK(std::acos(cosine) * 180 / std::numbers::pi <= 15.0001);
    places.insert(p[0]);
    farthest_right = std::max(farthest_right, pan_deg(p, 0.55));
    farthest_left = std::min(farthest_left, pan_deg(p, 0.55));
    last = p;
  }
  CHECK(places.size() == 599);
  CHECK(farthest_right > 23);
  CHECK(farthest_left < -23);
}

TEST_CASE("random depends on its seed and on nothing else, not even on the order of the questions") {
  ScenarioParams params = of_kind(ScenarioKind::Random);
  Scenario forward(params), backward(params);
  const auto late = backward.target_m(50 * kSecond);
  CHECK(backward.target_m(3 * kSecond) == forward.target_m(3 * kSecond));
  CHECK(forward.target_m(50 * kSecond) == late);
  params.seed = 2;
  CHECK(Scenario(params).target_m(50 * kSecond) != late);
}

TEST_CASE("a path is followed in straight lines, rests at its ends, and jumps between two points of one time") {
  ScenarioParams params = of_kind(ScenarioKind::Path);
  params.path = {{1, {0.1, 0}}, {1, {0.2, 0.1}}, {3, {0.4, -0.1}}};
  Scenario scenario(params);
  CHECK(scenario.target_m(0) == std::array{0.1, 0.0});
  CHECK(scenario.target_m(kSecond - 1) == std::array{0.1, 0.0});
  CHECK(scenario.target_m(kSecond) == std::array{0.2, 0.1});
  const auto half_way = scenario.target_m(2 * kSecond);
  CHECK(half_way[0] == doctest::Approx(0.3));
  CHECK(half_way[1] == doctest::Approx(0.0));
  CHECK(scenario.target_m(3 * kSecond) == std::array{0.4, -0.1});
  CHECK(scenario.target_m(9 * kSecond) == std::array{0.4, -0.1});
  CHECK(Scenario(of_kind(ScenarioKind::Path)).target_m(kSecond) == std::array{0.0, 0.0});
  CHECK(scenario.target_distance_m(kSecond) == params.wall_distance_m);
  params.path = {{1, {0, 0}, 0.3}, {3, {0, 0}}};
  CHECK(Scenario(params).target_distance_m(0) == 0.3);
  CHECK(Scenario(params).target_distance_m(2 * kSecond) == doctest::Approx((0.3 + params.wall_distance_m) / 2));
  CHECK(Scenario(params).target_distance_m(9 * kSecond) == params.wall_distance_m);
  CHECK(Scenario(of_kind(ScenarioKind::Step)).target_distance_m(kSecond) == params.wall_distance_m);
}
