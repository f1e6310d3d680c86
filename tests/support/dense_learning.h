// The rule of runtime/image/plasticity.h by brute force: every neuron in every tick, every pair at every reward.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/learn/learner.h"

namespace tectum::test {

class DenseLearning {
 public:
  explicit DenseLearning(const SpikeImage& image);

  void tick(std::span<const NeuronId> spikes);
  void reward(std::uint64_t tick, const RewardSample& sample);

  /// Of each plastic synapse, in the image's order.
  std::vector<std::int32_t> scales;
  std::vector<double> eligibilities;
  std::vector<std::int32_t> quanta;

 private:
  struct Rule {
    std::vector<double> pre_rate, pre_mean, post_rate, post_mean;
    std::vector<double> eligibility;  // [pre][post]
    double expected = 0;
    std::uint64_t samples = 0, rewards = 0;
  };
  void move(const PlasticityRecord& record, Rule& rule, std::uint64_t ticks, const RewardSample& sample);

  SpikeImage image_;
  std::vector<Rule> rules_;
  std::vector<std::vector<bool>> has_fired_;  // [tick since the last reward][neuron]
  std::uint64_t last_tick_ = 0;
};

}  // namespace tectum::test
