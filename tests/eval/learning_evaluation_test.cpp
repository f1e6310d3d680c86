// The evaluation of learning: starts that are off, and that a trial means the same every time.
#include "tools/evaluate/learning_evaluation.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "runtime/learn/plastic_weights.h"
#include "tests/learn/learning_fixture.h"

namespace tectum::test {
namespace {

SpikeImage learning_image() { return loaded(compiled(noisy_circuit(R"("reward": "pan", "learning_rate": "3 Hz")"))); }

}  // namespace

TEST_CASE("an image at other factors has their weights, and only those are other") {
  const SpikeImage image = learning_image();
  std::vector<std::int32_t> scales(image.plastic_synapses.size(), kScaleOne);
  scales[7] = kScaleOne / 2;
  const SpikeImage changed = with_scales(image, scales);
  const std::vector<std::uint32_t> places = plastic_weight_places(image);
  REQUIRE(changed.weights.size() == image.weights.size());
  for (std::size_t w = 0; w < image.weights.size(); ++w) {
    CAPTURE(w);
    CHECK(changed.weights[w] == (w == places[7] ? image.weights[w] / 2 : image.weights[w]));
  }
  CHECK(changed.plastic_synapses[7].scale == kScaleOne / 2);
}

TEST_CASE("a start that is off by 30 % has all weights onto a side too weak or all too strong") {
  const SpikeImage image = learning_image();
  int weak = 0, strong = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<std::int32_t> scales = perturbed_scales(image, 0.3, seed);
    std::map<std::uint32_t, std::int32_t> onto;
    for (const PlasticityRecord& rule : image.plasticity) {
      const std::uint32_t target = image.projections[rule.projection].post_population;
      for (std::uint32_t s = rule.first_synapse; s < rule.first_synapse + rule.synapse_count; ++s) {
        CHECK(onto.try_emplace(target, scales[s]).first->second == scales[s]);
      }
    }
    for (const auto& [target, scale] : onto) {
      const double factor = std::ldexp(scale, -kScaleBits);
      CHECK((factor == doctest::Approx(0.7) || factor == doctest::Approx(1.3)));
      (factor < 1 ? weak : strong) += 1;
    }
    CHECK(scales == perturbed_scales(image, 0.3, seed));
  }
  CHECK(weak > 5);
  CHECK(strong > 5);
  CHECK(perturbed_scales(image, 0, 3) == std::vector<std::int32_t>(image.plastic_synapses.size(), kScaleOne));
}

TEST_CASE("trials without, while and after learning are the same again on any number of threads") {
  const SpikeImage image = learning_image();
  Protocol protocol;
  protocol.kind = ProtocolKind::Learning;
  protocol.scenario.kind = ScenarioKind::Random;
  protocol.trials = 2;
  protocol.duration_s = 2;
  protocol.learning = {.perturbed = {0, 0.3}, .duration_s = 2, .first_seed = 50};
  const auto text = [&](unsigned threads) {
    return learning_json(protocol, "noisy", evaluate_learning(image, protocol, threads, {}));
  };
  const std::string once = text(1);
  CHECK(once == text(2));
  CHECK(std::count(once.begin(), once.end(), '{') > 8);
}

TEST_CASE("a trial is better when its mean over the channels is") {
  LearningResult result;
  LearningTrial trial;
  trial.rmse_deg = {ChannelRmse{2, 2, 2, 2}, ChannelRmse{1, 1, 2, 3}, ChannelRmse{3, 3, 1, 1}};
  result.trials = {trial, trial};
  CHECK(result.better(LearningPhase::Learning) == 2);
  CHECK(result.better(LearningPhase::Learned) == 0);
  CHECK(result.mean_rmse(LearningPhase::Learning)[3] == 3);
}

}  // namespace tectum::test
