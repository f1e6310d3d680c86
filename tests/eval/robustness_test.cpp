// Robustness: that nothing of a disturbance changes nothing, that each does what it says, and that seeds decide.
#include "tools/evaluate/robustness.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "compiler/compile.h"
#include "drivers/head/sim_head.h"
#include "tests/eval/evaluated_circuit.h"
#include "tools/evaluate/dot_finder.h"

using namespace tectum;

namespace {

/// The weight of each target, whether it shares it or not.
std::vector<std::int32_t> weights_by_target(const SpikeImage& image) {
  std::vector<std::int32_t> weights(image.targets.size());
  for (std::size_t s = 0; s + 1 < image.segments.size(); ++s) {
    const SegmentRecord& segment = image.segments[s];
    for (std::uint32_t t = segment.target_begin; t < image.segments[s + 1].target_begin; ++t) {
      const bool is_shared = (segment.flags & kSegmentOneWeight) != 0;
      weights[t] = image.weights[segment.weight_begin + (is_shared ? 0 : t - segment.target_begin)];
    }
  }
  return weights;
}

Protocol short_protocol() {
  Protocol protocol = shipped_protocol("robustness");
  protocol.trials = 1;
  protocol.duration_s = 2;
  return protocol;
}

/// Takes the named share of SC_left and SC_right, or of EBN.
std::optional<SpikeImage> lesioned(Disturbance disturbance, double share, std::uint64_t seed) {
  CompileOptions options;
  const std::string amount = ":" + std::to_string(share);
  options.lesions = disturbance == Disturbance::DeadFields
                        ? std::vector<std::string>{"SC_left" + amount, "SC_right" + amount}
                        : std::vector<std::string>{"EBN" + amount};
  options.seed = seed;
  return compiled_image("oculomotor.json", options);
}

RobustnessResult result_at(double level_share, unsigned threads) {
  RobustnessPlan plan;
  for (std::size_t d = 0; d < kDisturbances; ++d) {
    const DisturbanceFacts& facts = facts_of(static_cast<Disturbance>(d));
    plan.levels[d] = {level_share * std::min(facts.highest, 60.0)};
  }
  const auto result =
      evaluate_robustness(oculomotor_image(), short_protocol(), plan, lesioned, threads, [](double /*done*/) {});
  REQUIRE(result.has_value());
  return *result;
}

}  // namespace

TEST_CASE("the shipped plan tries every disturbance at two levels or more") {
  const std::string path = shipped_path("protocols/robustness.json");
  const ReadRobustness read = read_robustness_text(path, read_source(path).file.bytes);
  CHECK(read.problems.empty());
  REQUIRE(read.plan.has_value());
  for (const std::vector<double>& levels : read.plan->levels) {
    CHECK(levels.size() >= 2);
  }
}

TEST_CASE("a plan with a level that cannot be, or a name that is none, is refused with its place") {
  const ReadRobustness beyond =
      read_robustness_text("r.json", R"({ "robustness": { "dropped_frames": [0.1, 1.5], "sensor_nois": [1] } })");
  CHECK_FALSE(beyond.plan.has_value());
  CHECK(beyond.problems.find("r.json:1:43") != std::string::npos);
  CHECK(beyond.problems.find("0 to 0.99") != std::string::npos);
  CHECK(beyond.problems.find("did you mean `sensor_noise`?") != std::string::npos);
  for (const char* kind : {"robustness", "clinic"}) {
    const ReadProtocol none = read_protocol_text(
        "r.json", std::string(R"({ "tectum_protocol": 1, "target": { "kind": "random" }, "kind": ")") + kind + "\" }");
    CHECK_FALSE(none.protocol.has_value());
    CHECK(none.problems.find(std::string("`") + kind + "`") != std::string::npos);
  }
}

TEST_CASE("noise of no size leaves every weight, and otherwise each is off by no more than it says") {
  const SpikeImage& image = oculomotor_image();
  const std::vector<std::int32_t> weights = weights_by_target(image);
  CHECK(weights_by_target(with_weight_noise(image, 0, 3)) == weights);
  CHECK(weights_by_target(with_pathway_noise(image, 0, 3)) == weights);
  for (const auto& changed : {with_weight_noise(image, 0.3, 3), with_pathway_noise(image, 0.3, 3)}) {
    const std::vector<std::int32_t> noisy = weights_by_target(changed);
    double most = 0, sum = 0;
    for (std::size_t t = 0; t < weights.size(); ++t) {
      if (std::abs(weights[t]) > 1000) {  // whole quanta: small ones round
        const double off = static_cast<double>(noisy[t]) / weights[t] - 1;
        most = std::max(most, std::abs(off));
        sum += off;
      }
    }
    CHECK(most > 0.27);
    CHECK(most < 0.301);
    CHECK(std::abs(sum / static_cast<double>(weights.size())) < 0.1);
  }
  CHECK(weights_by_target(with_weight_noise(image, 0.3, 3)) == weights_by_target(with_weight_noise(image, 0.3, 3)));
  CHECK(weights_by_target(with_weight_noise(image, 0.3, 3)) != weights_by_target(with_weight_noise(image, 0.3, 4)));
}

TEST_CASE("a pathway has one factor for all its synapses, and pathways have factors of their own") {
  const SpikeImage& image = oculomotor_image();
  const std::vector<std::int32_t> weights = weights_by_target(image);
  const std::vector<std::int32_t> noisy = weights_by_target(with_pathway_noise(image, 0.3, 5));
  std::set<int> percents;
  for (const char* name : {"EBN.left", "OPN", "TN.right"}) {
    const auto population = std::find_if(image.populations.begin(), image.populations.end(),
                                         [&](const PopulationRecord& p) { return image.name(p.name) == name; });
    REQUIRE(population != image.populations.end());
    // The first target of every neuron is in the same population: rows are in the order of slots.
    std::set<int> mine;
    for (std::uint32_t i = 0; i < population->size; ++i) {
      const std::uint32_t t = image.segments[image.row_begin[population->first_neuron + i]].target_begin;
      mine.insert(static_cast<int>(std::lround(100.0 * noisy[t] / weights[t])));
    }
    CHECK(mine.size() == 1);
    percents.insert(*mine.begin());
  }
  CHECK(percents.size() == 3);
}

TEST_CASE("nothing of each disturbance is the undisturbed run to the last bit, much of each is not") {
  const RobustnessResult nothing = result_at(0, 2);
  const RobustnessResult much = result_at(0.5, 2);
  CHECK(nothing.undisturbed.circuit_deg == much.undisturbed.circuit_deg);
  for (std::size_t d = 0; d < kDisturbances; ++d) {
    const auto disturbance = static_cast<Disturbance>(d);
    CAPTURE(facts_of(disturbance).title);
    // A dot or a room of 0 grey levels is no undisturbed one.
    if (disturbance != Disturbance::DotBrightness && disturbance != Disturbance::RoomBrightness) {
      CHECK(nothing.levels[d][0].circuit_deg == nothing.undisturbed.circuit_deg);
    }
    CHECK(much.levels[d][0].circuit_deg.size() == 1);
    CHECK(much.levels[d][0].pid_deg.size() == (facts_of(disturbance).is_of_the_circuit ? 0 : 1));
  }
  for (const Disturbance disturbance :
       {Disturbance::SensorNoise, Disturbance::DroppedFrames, Disturbance::DotBrightness, Disturbance::DeadFields,
        Disturbance::LostNeurons, Disturbance::WeightNoise, Disturbance::PathwayNoise}) {
    CAPTURE(facts_of(disturbance).title);
    CHECK(much.levels[static_cast<std::size_t>(disturbance)][0].circuit_deg != much.undisturbed.circuit_deg);
  }
  CHECK(result_at(0.5, 1).levels[1][0].circuit_deg == much.levels[1][0].circuit_deg);
}

TEST_CASE("the tables have a row a level and the undisturbed, and no servo where it has no such part") {
  RobustnessResult result;
  result.undisturbed = {0, {2, 3}, {1, 1}, {0.9, 0.9}};
  result.levels[static_cast<std::size_t>(Disturbance::SensorNoise)] = {{4, {4, 6}, {2, 2}, {0.9, 0.9}}};
  result.levels[static_cast<std::size_t>(Disturbance::LostNeurons)] = {{0.2, {5, 5}, {}, {}}};
  const MeasuredProtocol measured = robustness_tables(result);
  REQUIRE(measured.tables.size() == 2);
  REQUIRE(measured.pictures.size() == 2);
  const MeasureRow& noisy = measured.tables[0].rows[1];
  CHECK(noisy.what == "4");
  CHECK(noisy.values == std::vector<std::optional<double>>{5, 1, 2, 2, 2, 0.9});
  const MeasureRow& lost = measured.tables[1].rows[1];
  CHECK(lost.what == "20 %");
  CHECK(lost.values[0] == 5);
  CHECK_FALSE(lost.values[3].has_value());
}

TEST_CASE("the servo's eye finds the dot where it is, in noise too that lights no pixel, and nothing in the dark") {
  const SpikeImage& image = oculomotor_image();
  for (const double sigma : {0.0, 3.0}) {
    SimHeadParams params = fitted_to(image, {});
    params.scenario.kind = ScenarioKind::Random;
    params.camera.noise_sigma = sigma;
    SimHead head(params);
    DotFinder finder(image, head.params().camera.field_of_view_deg);
    const double half_pixel_deg = 0.5 * params.camera.field_of_view_deg / params.camera.width_px;
    int found = 0;
    for (TimeNs turn = 1; turn < 200; turn += 20) {
      head.sleep_until(turn * params.frame_period_ns);
      HeadExposure exposure;
      Frame frame;
      REQUIRE(head.take_exposure(Eye::Left, head.now_ns(), exposure) == CameraStatus::NewFrame);
      head.draw(Eye::Left, exposure, frame);
      const Direction truth = error_in_eye(eye_pose(params.geometry, exposure.joint_deg, Eye::Left),
                                           {exposure.target_m[0], exposure.target_m[1], exposure.target_distance_m});
      const auto dot = finder.find(frame);
      if (dot) {
        ++found;
        CHECK(std::abs(dot->pan_deg - truth.pan_deg) < half_pixel_deg);
        CHECK(std::abs(dot->tilt_deg - truth.tilt_deg) < half_pixel_deg);
      }
    }
    CHECK(found > 3);
  }
  std::vector<std::uint8_t> dark(std::size_t{3} * 32 * 32, 10);
  DotFinder finder(image, 39.4);
  CHECK_FALSE(finder.find({dark.data(), 32, 32, 96, 0, 0}).has_value());
}
