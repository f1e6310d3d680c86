#include "tools/analysis/saccades.h"

#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <random>

namespace tectum {
namespace {

struct Planned {
  double onset_s;
  double duration_s;
  double pan_deg;
  double tilt_deg;
};

/// Minimum-jerk displacements (Flash & Hogan 1985, doi:10.1523/JNEUROSCI.05-07-01688.1985) with white noise.
AngleTrace minimum_jerk_trace(const std::vector<Planned>& plan, double rate_hz, double length_s, double noise_sd_deg,
                              unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0, 1);
  AngleTrace trace;
  const auto count = static_cast<std::size_t>(length_s * rate_hz);
  for (std::size_t k = 0; k < count; ++k) {
    const double t_s = static_cast<double>(k) / rate_hz;
    double pan_deg = noise_sd_deg * noise(generator);
    double tilt_deg = noise_sd_deg * noise(generator);
    for (const Planned& move : plan) {
      const double s = std::clamp((t_s - move.onset_s) / move.duration_s, 0.0, 1.0);
      const double done = s * s * s * (10 - 15 * s + 6 * s * s);
      pan_deg += done * move.pan_deg;
      tilt_deg += done * move.tilt_deg;
    }
    trace.time_s.push_back(t_s);
    trace.pan_deg.push_back(pan_deg);
    trace.tilt_deg.push_back(tilt_deg);
  }
  return trace;
}

TEST_CASE("minimum-jerk saccades are counted exactly and measured within 5 %") {
  const std::vector<Planned> plan = {
      {0.5, 0.05, 10, 0}, {1.2, 0.06, -12, 5}, {2.0, 0.03, 2, -2}, {2.8, 0.08, 0, 20}, {3.5, 0.03, 3, 0}};
  const AngleTrace trace = minimum_jerk_trace(plan, 1000, 4.5, 0.005, 7);
  const std::vector<Saccade> saccades = detect_saccades(trace);
  REQUIRE(saccades.size() == plan.size());
  for (std::size_t k = 0; k < plan.size(); ++k) {
    CAPTURE(k);
    const double amplitude_deg = std::hypot(plan[k].pan_deg, plan[k].tilt_deg);
    CHECK(saccades[k].amplitude_deg == doctest::Approx(amplitude_deg).epsilon(0.05));
    // A minimum-jerk movement peaks at 15/8 of its mean velocity, halfway.
    CHECK(saccades[k].peak_velocity_deg_s == doctest::Approx(1.875 * amplitude_deg / plan[k].duration_s).epsilon(0.05));
    CHECK(saccades[k].skewness == doctest::Approx(0.5).epsilon(0.15));
    CHECK(saccades[k].onset_s >= plan[k].onset_s - 0.002);
    CHECK(saccades[k].offset_s <= plan[k].onset_s + plan[k].duration_s + 0.003);
    CHECK(saccades[k].duration_s > 0.7 * plan[k].duration_s);
  }
}

TEST_CASE("pure noise holds no saccade") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    CAPTURE(seed);
    CHECK(detect_saccades(minimum_jerk_trace({}, 500, 10, 0.02, seed)).empty());
  }
}

TEST_CASE("an eye that does not move at all makes no saccade") {
  CHECK(detect_saccades(minimum_jerk_trace({}, 1000, 1, 0, 1)).empty());
}

TEST_CASE("an overshoot that returns at once belongs to its saccade") {
  const AngleTrace trace = minimum_jerk_trace({{0.5, 0.05, 11, 0}, {0.556, 0.03, -1, 0}}, 1000, 1, 0, 1);
  const std::vector<Saccade> saccades = detect_saccades(trace);
  REQUIRE(saccades.size() == 1);
  CHECK(saccades[0].amplitude_deg == doctest::Approx(10).epsilon(0.02));
}

TEST_CASE("movements further apart than the minimum gap stay apart") {
  const AngleTrace trace = minimum_jerk_trace({{0.5, 0.05, 10, 0}, {0.65, 0.03, 2, 0}}, 1000, 1, 0, 1);
  CHECK(detect_saccades(trace).size() == 2);
}

TEST_CASE("at a camera's rate a step is one saccade and a servo's single step is none") {
  AngleTrace trace;
  for (int k = 0; k < 90; ++k) {
    trace.time_s.push_back(k / 45.0);
    const double flicker_deg = k % 10 == 0 ? 0.29 : 0.0;
    trace.pan_deg.push_back(flicker_deg + (k < 40 ? 0.0 : k == 40 ? 4.0 : 10.0));
    trace.tilt_deg.push_back(0);
  }
  const std::vector<Saccade> saccades = detect_saccades(trace, frame_rate_saccade_options(1 / 45.0));
  REQUIRE(saccades.size() == 1);
  CHECK(saccades[0].onset_s == doctest::Approx(39 / 45.0));
  CHECK(saccades[0].amplitude_deg == doctest::Approx(10).epsilon(0.03));
}

TEST_CASE("latency runs from a jump to the first saccade after it, and a jump without one has none") {
  std::vector<Saccade> saccades(3);
  saccades[0].onset_s = 1.2;
  saccades[1].onset_s = 1.4;  // corrective: second after the same jump
  saccades[2].onset_s = 3.3;
  const std::vector<double> latencies_s = saccade_latencies_s(saccades, {1.0, 2.0, 3.0});
  REQUIRE(latencies_s.size() == 2);
  CHECK(latencies_s[0] == doctest::Approx(0.2));
  CHECK(latencies_s[1] == doctest::Approx(0.3));
}

TEST_CASE("traces too short to differentiate hold no saccade") {
  CHECK(detect_saccades(AngleTrace{}).empty());
  CHECK(detect_saccades(minimum_jerk_trace({}, 100, 0.03, 1, 1)).empty());
}

}  // namespace
}  // namespace tectum
