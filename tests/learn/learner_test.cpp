// The rule by which weights change.
#include "runtime/learn/learner.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "runtime/engine/spike_engine.h"
#include "tests/learn/learning_fixture.h"
#include "tests/support/dense_learning.h"

namespace tectum::test {
namespace {

const std::string kRule = R"("reward": "pan", "learning_rate": "3 Hz")";

/// Spikes of A and B in each step of 20 ms, and the reward at its end.
struct Story {
  std::uint32_t pre, post;
  double reward;
};

/// The weight's factor after each step of a story.
std::vector<double> factors_in(const std::string& plasticity, int steps, const std::function<Story(int)>& story) {
  const SpikeImage image = loaded(compiled(pair_circuit(plasticity)));
  Learner learner(image);
  std::vector<std::int32_t> weights(image.weights.begin(), image.weights.end());
  std::vector<double> factors;
  constexpr std::array<NeuronId, 1> kPre = {NeuronId{0}};
  constexpr std::array<NeuronId, 1> kPost = {NeuronId{1}};
  for (int step = 0; step < steps; ++step) {
    const Story now = story(step);
    for (std::uint32_t k = 0; k < now.pre; ++k) {
      learner.take_spikes(kPre);
    }
    for (std::uint32_t k = 0; k < now.post; ++k) {
      learner.take_spikes(kPost);
    }
    learner.take_reward(static_cast<std::uint64_t>(step + 1) * 20, pan_reward(now.reward), weights);
    factors.push_back(std::ldexp(learner.scales()[0], -kScaleBits));
  }
  return factors;
}

double factor_after(const std::string& plasticity, int steps, const std::function<Story(int)>& story) {
  return factors_in(plasticity, steps, story).back();
}

/// Both neurons burst together for half a second of each 10 s, a little into it; the first half of each 10 s has one
/// reward, the second another.
Story bursts(int step, double reward_then, double reward_else) {
  const int phase = step % 500;
  const bool now = phase >= 50 && phase < 75;
  return {now ? 2U : 0U, now ? 2U : 0U, phase < 250 ? reward_then : reward_else};
}

}  // namespace

TEST_CASE("learning by events is a sweep over everything, to the last bit") {
  for (const char* form : {"three_factor", "seed_eq2", "seed_code"}) {
    CAPTURE(form);
    const SpikeImage image = loaded(compiled(noisy_circuit(fmt::format(R"({}, "form": "{}")", kRule, form))));
    SpikeEngine engine(image);
    Learner learner(image);
    DenseLearning dense(image);
    std::mt19937 random(3);
    for (int turn = 0; turn < 400; ++turn) {
      const int ticks = turn == 200 ? 40'000 : 30 + static_cast<int>(random() % 30);
      for (int t = 0; t < ticks; ++t) {
        engine.step();
        // After a long silence of the record everything has decayed to nothing, and rows are skipped.
        if (turn != 200) {
          learner.take_spikes(engine.spikes());
          dense.tick(engine.spikes());
        }
      }
      RewardSample sample = pan_reward(std::generate_canonical<double, 53>(random));
      sample.given = turn % 7 == 3 ? 0 : sample.given;
      learner.take_reward(engine.tick(), sample, engine.plastic_weights());
      dense.reward(engine.tick(), sample);
    }
    REQUIRE(learner.scales().size() == 50);
    int moved = 0;
    for (std::size_t s = 0; s < learner.scales().size(); ++s) {
      CAPTURE(s);
      CHECK(learner.scales()[s] == dense.scales[s]);
      CHECK(learner.eligibilities()[s] == dense.eligibilities[s]);
      moved += learner.scales()[s] == kScaleOne ? 0 : 1;
    }
    CHECK(moved > 40);
    // What the engine delivers is what was learned.
    for (std::size_t s = 0; s < image.plastic_synapses.size(); ++s) {
      const std::span<const std::int32_t> weights = engine.plastic_weights();
      CHECK(std::find(weights.begin(), weights.end(), dense.quanta[s]) != weights.end());
    }
  }
}

TEST_CASE("a circuit that learns fires alike on any number of threads and by any sweep") {
  const SpikeImage image = loaded(compiled(noisy_circuit(kRule)));
  std::vector<std::vector<std::uint64_t>> rasters;
  for (const EngineOptions& options :
       {EngineOptions{}, EngineOptions{.threads = 2}, EngineOptions{.sweep = SweepStrategy::Sparse},
        EngineOptions{.sweep = SweepStrategy::Dense, .simd = SimdLevel::Portable}}) {
    SpikeEngine engine(image, options);
    Learner learner(image);
    std::vector<std::uint64_t>& raster = rasters.emplace_back();
    for (std::uint64_t turn = 1; turn <= 60; ++turn) {
      while (engine.tick() < turn * 40) {
        const std::uint64_t first = engine.tick();
        const std::uint32_t done = engine.advance(turn * 40 - first);
        for (std::uint32_t k = 0; k < done; ++k) {
          learner.take_spikes(engine.spikes(k));
          for (const NeuronId neuron : engine.spikes(k)) {
            raster.push_back((first + k) << 8U | static_cast<std::uint64_t>(neuron));
          }
        }
      }
      learner.take_reward(engine.tick(), pan_reward(turn % 3 == 0 ? 1.0 : 0.2), engine.plastic_weights());
    }
    CHECK(raster == rasters.front());
  }
  CHECK(rasters.front().size() > 300);
}

TEST_CASE("a constant reward changes no weight, whatever fires") {
  std::mt19937 random(1);
  CHECK(factor_after(kRule, 500, [&](int) {
          return Story{static_cast<std::uint32_t>(random() % 5), static_cast<std::uint32_t>(random() % 5), 0.7};
        }) == 1.0);
}

TEST_CASE("a reward that is noise changes a weight by nothing on average") {
  // Standard error from 40 stories; a bias of a fifth of one story's spread would show.
  std::vector<double> changes;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    changes.push_back(factor_after(R"("reward": "pan", "learning_rate": "1 Hz")", 500,
                                   [&](int step) {
                                     const Story story = bursts(step, 0, 0);
                                     return Story{story.pre, story.post, std::generate_canonical<double, 53>(random)};
                                   }) -
                      1);
  }
  double mean = 0, square = 0;
  for (const double change : changes) {
    mean += change / 40;
    square += change * change / 40;
  }
  CHECK(square > 0);
  CHECK(std::abs(mean) < 3 * std::sqrt(square / 40));
}

TEST_CASE("what goes with a good reward grows, what goes with a bad one shrinks") {
  const auto after = [](double then, double otherwise) {
    return factor_after(kRule, 3000, [&](int step) { return bursts(step, then, otherwise); });
  };
  CHECK(after(1, 0) > 1.02);
  CHECK(after(0, 1) < 0.98);
}

TEST_CASE("the reward counts by what was expected of it: a constant added to it changes nothing") {
  const auto after = [](double offset) {
    return factor_after(kRule, 3000, [&](int step) { return bursts(step, 1 + offset, offset); });
  };
  CHECK(after(8) == doctest::Approx(after(0)).epsilon(1e-6));
}

TEST_CASE("rates count by their means: a steady rate more changes nothing") {
  const auto after = [](std::uint32_t more) {
    return factor_after(kRule, 3000, [&](int step) {
      const Story story = bursts(step, 1, 0);
      return Story{story.pre + more, story.post + more, story.reward};
    });
  };
  CHECK(after(3) == doctest::Approx(after(0)).epsilon(1e-6));
  CHECK(std::abs(after(0) - 1) > 0.02);
}

TEST_CASE("no weight leaves its bounds or changes its sign") {
  const auto extremes = [](const std::string& bounds) {
    const std::vector<double> factors = factors_in(R"("reward": "pan", "learning_rate": "1 kHz")" + bounds, 1000,
                                                   [](int step) { return bursts(step, 1, 0); });
    const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
    return std::pair(*least, *most);
  };
  CHECK(extremes(R"(, "bounds": [0.5, 1.5])") == std::pair(0.5, 1.5));
  CHECK(extremes("") == std::pair(0.0, 2.0));
}

TEST_CASE("the published program only ever strengthens") {
  const std::string code = R"("reward": "pan", "form": "seed_code", "learning_rate": "3 Hz")";
  CHECK(factor_after(code, 1000, [](int step) { return bursts(step, 1, 0); }) > 1.02);
  CHECK(factor_after(code, 1000, [](int step) { return bursts(step, 0, 1); }) > 1.02);
}

TEST_CASE("the equation as printed has the wrong sign where the rates part, and the three-factor rule has not") {
  // Both neurons always fire in turns (H < 0), and more so in the better 10 s of each 20: the weight should shrink.
  const auto story = [](int step) {
    const bool good = step / 500 % 2 == 0;
    const std::uint32_t spikes = good ? 6 : 2;
    return Story{step % 2 == 0 ? spikes : 0, step % 2 == 1 ? spikes : 0, good ? 1.0 : 0.0};
  };
  const std::string common = R"("reward": "pan", "learning_rate": "0.001 Hz", "tau_rate": "5 ms")";
  CHECK(factor_after(common, 4000, story) < 0.999);
  CHECK(factor_after(common + R"(, "form": "seed_eq2")", 4000, story) > 1.001);
}

TEST_CASE("a reward that is no number, and one of another channel, teach nothing") {
  const auto story = [](int step) { return Story{5, 5, step % 2 == 0 ? std::nan("") : 1e300}; };
  CHECK(factor_after(kRule, 50, story) == 1.0);
  CHECK(factor_after(R"("reward": "tilt", "learning_rate": "3 Hz")", 300,
                     [](int step) { return bursts(step, 1, 0); }) == 1.0);
}

TEST_CASE("a reset brings back weights and raster") {
  const SpikeImage image = loaded(compiled(noisy_circuit(kRule)));
  SpikeEngine engine(image);
  Learner learner(image);
  std::array<std::vector<std::int32_t>, 2> learned;
  for (std::vector<std::int32_t>& weights : learned) {
    CHECK(std::equal(image.weights.begin(), image.weights.end(), engine.plastic_weights().begin()));
    for (int turn = 0; turn < 50; ++turn) {
      for (int t = 0; t < 40; ++t) {
        engine.step();
        learner.take_spikes(engine.spikes());
      }
      learner.take_reward(engine.tick(), pan_reward(turn % 2), engine.plastic_weights());
    }
    weights.assign(engine.plastic_weights().begin(), engine.plastic_weights().end());
    engine.reset();
    learner.reset();
  }
  CHECK(learned[0] == learned[1]);
  CHECK_FALSE(std::equal(image.weights.begin(), image.weights.end(), learned[0].begin()));
}

TEST_CASE("rows of neurons that have nothing to tell are passed over") {
  const SpikeImage image = loaded(compiled(noisy_circuit(kRule)));
  Learner learner(image);
  std::vector<std::int32_t> weights(image.weights.begin(), image.weights.end());
  learner.take_reward(40, pan_reward(1), weights);
  CHECK(learner.rows_visited() == 0);
  constexpr std::array<NeuronId, 2> kSpikes = {NeuronId{0}, NeuronId{1}};  // of A
  learner.take_spikes(kSpikes);
  learner.take_reward(80, pan_reward(0), weights);
  CHECK(learner.rows_visited() == 2);
  for (std::uint64_t turn = 0; turn < 100; ++turn) {
    learner.take_reward(80 + (turn + 1) * 2000, pan_reward(0), weights);
  }
  CHECK(learner.rows_visited() == 0);
}

}  // namespace tectum::test
