// The clinic: that its measures see what an eye does, that the whole circuit has no sign, that a lesion brings its own.
#include "tools/evaluate/clinic.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "compiler/compile.h"
#include "tests/eval/evaluated_circuit.h"

using namespace tectum;

namespace {

const ClinicPlan& shipped_plan() {
  static const ClinicPlan kPlan = [] {
    const std::string path = shipped_path("protocols/clinic.json");
    const ReadClinic read = read_clinic_text(path, read_source(path).file.bytes);
    CAPTURE(read.problems);
    REQUIRE(read.plan.has_value());
    return *read.plan;
  }();
  return kPlan;
}

ClinicTrial trial_without(std::vector<std::string> lesions, std::uint64_t seed = 0) {
  lesions.insert(lesions.end(), {"MN_neck", "MN_neck_v"});
  CompileOptions options;
  options.lesions = std::move(lesions);
  Protocol protocol = shipped_protocol("clinic");
  protocol.first_seed = seed;
  return clinic_trial(compiled_image("oculomotor.json", options), protocol, shipped_plan());
}

const ClinicTrial& whole() {
  static const ClinicTrial kWhole = trial_without({});
  return kWhole;
}

const ClinicLesion& lesion_named(const std::string& name) {
  for (const ClinicLesion& lesion : shipped_plan().lesions) {
    if (lesion.name.starts_with(name)) {
      return lesion;
    }
  }
  FAIL("no lesion ", name);
  return shipped_plan().lesions.front();
}

/// Eyes that go where `gaze` says for each step of the dot, at once, and decay towards the middle with `tau_s`.
ClinicTrial imagined(const ClinicPlan& plan, double tau_s, double (*pan_deg)(double dot_deg)) {
  ClinicTrial trial;
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    for (const ClinicStep& step : clinic_steps(plan)) {
      for (double at_s = step.begin_s; at_s < step.end_s - 1e-9; at_s += 0.002) {
        const double since_s = at_s - step.begin_s - 0.1;
        const double ramp = std::clamp(since_s / 0.04, 0.0, 1.0);
        const double held = tau_s > 0 && since_s > 0.04 ? std::exp(-(since_s - 0.04) / tau_s) : 1;
        trial.command[eye].time_s.push_back(at_s);
        trial.command[eye].pan_deg.push_back(step.is_dark ? 0 : pan_deg(step.pan_deg) * ramp * held);
        trial.command[eye].tilt_deg.push_back(0);
      }
    }
    for (double at_s = 0; at_s < plan.near_s; at_s += 0.002) {
      trial.near[eye].time_s.push_back(at_s);
      trial.near[eye].pan_deg.push_back(eye == 0 ? 4 : -4);
      trial.near[eye].tilt_deg.push_back(0);
    }
  }
  return trial;
}

}  // namespace

TEST_CASE("the measures of eyes that follow the dot are the dot's") {
  const ClinicPlan& plan = shipped_plan();
  const ClinicTrial eyes = imagined(plan, 0, [](double dot_deg) { return dot_deg; });
  const Measures seen = clinic_measures(eyes, eyes, plan);
  CHECK(seen.at("left_eye.reach.left") == doctest::Approx(plan.jump_deg).epsilon(0.05));
  CHECK(seen.at("right_eye.reach.right") == doctest::Approx(plan.jump_deg).epsilon(0.05));
  CHECK(seen.at("left_eye.first_saccade.right") == doctest::Approx(plan.jump_deg).epsilon(0.1));
  CHECK(seen.at("left_eye.reach.up") == doctest::Approx(0));
  CHECK(seen.at("left_eye.saccades.up") == 0);
  CHECK(seen.at("left_eye.ripple") == doctest::Approx(0));
  CHECK(seen.at("left_eye.convergence") == doctest::Approx(4));
}

TEST_CASE("an eye that cannot pass the middle, and one that drifts back, are seen as such") {
  const ClinicPlan& plan = shipped_plan();
  const ClinicTrial sound = imagined(plan, 0, [](double dot_deg) { return dot_deg; });
  const ClinicTrial stuck = imagined(plan, 0, [](double dot_deg) { return std::max(0.0, dot_deg); });
  CHECK(clinic_measures(stuck, sound, plan).at("left_eye.reach.left") < 0.1);
  CHECK(clinic_measures(stuck, sound, plan).at("left_eye.first_saccade.left") == 0);
  const ClinicTrial leaky = imagined(plan, 0.2, [](double dot_deg) { return dot_deg; });
  CHECK(clinic_measures(leaky, sound, plan).at("left_eye.drift_time") == doctest::Approx(0.2).epsilon(0.3));
  CHECK(clinic_measures(sound, sound, plan).at("left_eye.drift_time") > 10);
}

TEST_CASE(
    "the whole circuit shows none of the signs, neither in the run that lesions are held against nor in another") {
  const ClinicTrial other = trial_without({}, 1);
  for (const ClinicLesion& lesion : shipped_plan().lesions) {
    CAPTURE(lesion.name);
    const ClinicResult result = judge(lesion, other, whole(), shipped_plan());
    CHECK(result.verdict == ClinicVerdict::Misses);
    CHECK(!result.is_shown_by_the_whole());
  }
}

TEST_CASE("a palsy of the sixth nerve and one of the PPRF bring their own signs and not each other's") {
  const ClinicTrial sixth = trial_without({"MN_lateral.left"});
  const ClinicTrial pprf = trial_without(lesion_named("PPRF").remove);
  const auto shows = [](const ClinicTrial& trial, const std::string& name) {
    return judge(lesion_named(name), trial, whole(), shipped_plan()).verdict == ClinicVerdict::Shows;
  };
  CHECK(shows(sixth, "sixth nerve"));
  CHECK(!shows(sixth, "PPRF"));
  CHECK(!shows(sixth, "abducens"));
  CHECK(shows(pprf, "PPRF"));
  CHECK(!shows(pprf, "sixth nerve"));
  CHECK(!shows(pprf, "riMLF"));
}

TEST_CASE("every lesion of the clinic names a source, and the problems of a plan are told by place") {
  for (const ClinicLesion& lesion : shipped_plan().lesions) {
    CAPTURE(lesion.name);
    CHECK(!lesion.source.empty());
    CHECK(!lesion.sign.empty());
  }
  const ReadClinic read = read_clinic_text("mine.json", R"({ "clinic": { "lesions": [ { "name": "a", "remove": ["A"],
    "findings": [ { "says": "b", "measure": "left_eye.reech.left", "below": 1 } ] } ] } })");
  CHECK(!read.plan.has_value());
  CHECK(read.problems.find("did you mean `left_eye.reach.left`?") != std::string::npos);
}
