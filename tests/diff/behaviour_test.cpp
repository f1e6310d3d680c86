// The measures of a comparison on movements and spike trains whose numbers are known.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tools/diff/behaviour.h"
#include "tools/diff/kinematics.h"
#include "tools/diff/spike_distance.h"

using namespace tectum;

namespace {

constexpr std::size_t kPan = 0, kTilt = 1;

double smooth_step(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

/// Both eyes follow `gaze_deg(t)`, the target of both goes by `target_deg(t)`: pan and tilt.
template <typename Gaze, typename Target>
Recording moving_eyes(double duration_s, Gaze gaze_deg, Target target_deg) {
  Recording recording;
  recording.tick_ns = 500'000;
  recording.frame_period_ns = 20'000'000;
  recording.duration_s = duration_s;
  recording.wall_distance_m = 1;
  for (int k = 0; k * 0.002 < duration_s; ++k) {
    RecordedPositions sample;
    sample.time_ns = k * TimeNs{2'000'000};
    const std::array<double, 2> deg = gaze_deg(k * 0.002);
    for (const auto& [pan, tilt] :
         {std::pair{Joint::LeftEyePan, Joint::LeftEyeTilt}, std::pair{Joint::RightEyePan, Joint::RightEyeTilt}}) {
      sample.position_deg[static_cast<std::size_t>(pan)] = deg[kPan];
      sample.position_deg[static_cast<std::size_t>(tilt)] = deg[kTilt];
    }
    recording.positions.push_back(sample);
  }
  for (int k = 0; k * 0.02 < duration_s; ++k) {
    RecordedFrame frame;
    frame.time_ns = k * TimeNs{20'000'000};
    frame.tick = static_cast<std::uint64_t>(k) * 40;
    frame.has_truth = true;
    const std::array<double, 2> target = target_deg(k * 0.02), gaze = gaze_deg(k * 0.02);
    frame.target_on_wall_m = {std::tan(target[kPan] * 0.017453292519943295),
                              std::tan(target[kTilt] * 0.017453292519943295)};
    for (EyeTruth& eye : frame.eye) {
      eye.target_pan_deg = target[kPan];
      eye.target_tilt_deg = target[kTilt];
      eye.error_pan_deg = target[kPan] - gaze[kPan];
      eye.error_tilt_deg = target[kTilt] - gaze[kTilt];
    }
    recording.frames.push_back(std::move(frame));
  }
  return recording;
}

double figure(const std::vector<KinematicFigure>& figures, const std::string& name) {
  for (const KinematicFigure& figure : figures) {
    if (figure.name == name) {
      REQUIRE(figure.value.has_value());
      return *figure.value;
    }
  }
  FAIL("no figure ", name);
  return 0;
}

/// The definition, cell by cell.
double edit_distance(const std::vector<double>& a, const std::vector<double>& b, double cost) {
  std::vector<std::vector<double>> cell(a.size() + 1, std::vector<double>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cell[i][j] = static_cast<double>(i + j);
        continue;
      }
      cell[i][j] =
          std::min({cell[i - 1][j] + 1, cell[i][j - 1] + 1, cell[i - 1][j - 1] + cost * std::abs(a[i - 1] - b[j - 1])});
    }
  }
  return cell[a.size()][b.size()];
}

/// One population of `size` neurons; each fires at 20 Hz, and at 200 Hz for 100 ms from `delay_s` after each step on.
Recording answering(const std::vector<double>& steps_s, double delay_s, double duration_s) {
  constexpr std::uint32_t kSize = 20;
  Recording recording = moving_eyes(
      duration_s,
      [](double) {
        return std::array{0.0, 0.0};
      },
      [](double) {
        return std::array{0.0, 0.0};
      });
  recording.populations = {{"EBN.left", "PPRF", 0, kSize}};
  for (std::uint32_t neuron = 0; neuron < kSize; ++neuron) {
    const double phase_s = 0.05 * neuron / kSize;
    for (double t = phase_s; t < duration_s; t += 0.05) {
      recording.spikes.push_back({static_cast<std::uint32_t>(t * 2000), neuron});
    }
    for (const double step_s : steps_s) {
      for (double t = step_s + delay_s + phase_s / 10; t < step_s + delay_s + 0.1; t += 0.005) {
        recording.spikes.push_back({static_cast<std::uint32_t>(t * 2000), neuron});
      }
    }
  }
  std::sort(recording.spikes.begin(), recording.spikes.end(), [](const RecordedSpike& x, const RecordedSpike& y) {
    return x.tick != y.tick ? x.tick < y.tick : x.neuron < y.neuron;
  });
  return recording;
}

}  // namespace

TEST_CASE("a step's latency, amplitude, overshoot and rest are those of the movement") {
  // 100 ms after the step 11 deg in 40 ms, and 150 ms later the 1 deg too many back.
  const auto share = [](double t) {
    return 1.1 * smooth_step((t - 0.6) / 0.04) - 0.1 * smooth_step((t - 0.79) / 0.04);
  };
  const Recording recording = moving_eyes(
      1.1,
      [&](double t) {
        return std::array{6 * share(t), 8 * share(t)};
      },
      [](double t) {
        return t < 0.5 ? std::array{0.0, 0.0} : std::array{6.0, 8.0};
      });
  const std::vector<RunPart> parts = {{PartKind::Fixation, 0, 0.5}, {PartKind::Step, 0.5, 1.1}};
  const std::vector<KinematicFigure> figures = kinematics(recording, parts);
  CHECK(figure(figures, "saccade latency") == doctest::Approx(100).epsilon(0.06));
  CHECK(figure(figures, "saccade amplitude") == doctest::Approx(11).epsilon(0.03));
  CHECK(figure(figures, "overshoot") == doctest::Approx(10).epsilon(1e-6));
  // The steepest of a smooth step is 1.5 of its mean.
  CHECK(figure(figures, "peak velocity") == doctest::Approx(1.5 * 11 / 0.04).epsilon(0.05));
  CHECK(figure(figures, "fixation spread") == 0);
  CHECK(figure(figures, "settled RMSE") == doctest::Approx(0).epsilon(1e-9));
  CHECK(parts_of(recording).size() == 2);
  CHECK(parts_of(recording)[1].kind == PartKind::Step);
  CHECK(parts_of(recording)[1].begin_s == doctest::Approx(0.5));
}

TEST_CASE("an eye that moves nine tenths as fast as the target has a pursuit gain of 0.9") {
  const Recording recording = moving_eyes(
      2,
      [](double t) {
        return std::array{0.9 * 12 * t - 1, 0.9 * 5 * t};
      },
      [](double t) {
        return std::array{12 * t, 5 * t};
      });
  const std::vector<RunPart> parts = parts_of(recording);
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].kind == PartKind::Pursuit);
  CHECK(figure(kinematics(recording, parts), "pursuit gain") == doctest::Approx(0.9).epsilon(1e-3));
}

TEST_CASE("a change is held against how it varies from seed to seed, not against how the seeds vary") {
  PairedFigure figure{"latency", "ms", {60, 90, 120}, {62, 92.5, 121.5}};
  CHECK(figure.difference() == doctest::Approx(2));
  CHECK(figure.spread() == doctest::Approx(0.5));
  CHECK(figure.exceeds_spread() == true);
  figure.b[1] = 89;  // one seed goes the other way
  CHECK(figure.exceeds_spread() == false);
  CHECK_FALSE(PairedFigure{"latency", "ms", {60}, {62}}.exceeds_spread().has_value());
}

TEST_CASE("a population that answers 12 ms later is found to") {
  const std::vector<double> steps_s = {0.3, 0.7, 1.1};
  const Recording a = answering(steps_s, 0.06, 1.5), b = answering(steps_s, 0.072, 1.5);
  const std::vector<RunPart> parts = {
      {PartKind::Step, 0.3, 0.7}, {PartKind::Step, 0.7, 1.1}, {PartKind::Step, 1.1, 1.5}};
  const std::vector<PopulationDifference> found = compare_spikes({{a, b, parts}}, {0});
  REQUIRE(found.size() == 1);
  REQUIRE(found[0].latency.a.size() == 1);
  CHECK(found[0].latency.mean_a() == doctest::Approx(60).epsilon(0.05));
  CHECK(found[0].latency.difference() == doctest::Approx(12).epsilon(0.05));
  CHECK(found[0].van_rossum > 0);
  CHECK(compare_spikes({{a, a, parts}}, {0}).empty());
}

TEST_CASE("the Victor-Purpura distance of long trains is that of its definition") {
  constexpr unsigned kSeed = 5;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (const double cost : {0.02, 0.1, 1.0, 5.0}) {
    for (int round = 0; round < 20; ++round) {
      std::vector<double> a(random() % 60), b(random() % 60);
      for (std::vector<double>* train : {&a, &b}) {
        std::generate(train->begin(), train->end(), [&] { return static_cast<double>(random() % 4000) * 0.5; });
        std::sort(train->begin(), train->end());
      }
      CHECK(victor_purpura_distance(a, b, cost) == doctest::Approx(edit_distance(a, b, cost)).epsilon(1e-12));
    }
  }
}

TEST_CASE("an edit that acts at a later place is named as its cause, and a pathway as the way there") {
  Divergence divergence;
  DivergenceLink first, edited, reached;
  first.what = "EBN[0]";
  first.time_ms = 1;
  edited.what = "EBN_v[0]";
  edited.time_ms = 2;
  edited.how = "fires in the second only";
  edited.why = "weight of llbn_ebn_v is 2 nA instead of 1 nA";
  reached.what = "IBN[0]";
  reached.time_ms = 3;
  reached.how = "fires in the second only";
  reached.why = "through ebn_ibn";
  reached.from = "EBN";
  divergence.links = {first, edited, reached};
  const std::string text = divergence_text(divergence);
  CAPTURE(text);
  CHECK(text.find("fires in the second only, because weight of llbn_ebn_v is 2 nA") != std::string::npos);
  CHECK(text.find("fires in the second only, through ebn_ibn") != std::string::npos);
}
