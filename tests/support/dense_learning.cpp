#include "tests/support/dense_learning.h"

#include <algorithm>
#include <cmath>

namespace tectum::test {
namespace {

double no_dust(double value) { return std::abs(value) < Learner::kSmallest ? 0.0 : value; }

double decay(const SpikeImage& image, const PlasticityRecord& record, std::uint32_t which, std::uint64_t ticks) {
  double product = 1;
  for (std::uint32_t digit = 0; digit < kDecayPowers; ++digit) {
    if (ticks % 2 == 1) {
      product = product * image.decays[record.first_decay + which * kDecayPowers + digit];
    }
    ticks /= 2;
  }
  return product;
}

double gain(double keep, std::uint64_t count) { return std::max(1.0 - keep, 1.0 / static_cast<double>(count)); }

}  // namespace

DenseLearning::DenseLearning(const SpikeImage& image) : image_(image), rules_(image.plasticity.size()) {
  for (std::size_t p = 0; p < rules_.size(); ++p) {
    const ProjectionRecord& projection = image.projections[image.plasticity[p].projection];
    const std::size_t pre = image.populations[projection.pre_population].size;
    const std::size_t post = image.populations[projection.post_population].size;
    rules_[p].pre_rate.assign(pre, 0);
    rules_[p].pre_mean.assign(pre, 0);
    rules_[p].post_rate.assign(post, 0);
    rules_[p].post_mean.assign(post, 0);
    rules_[p].eligibility.assign(pre * post, 0);
  }
  for (const PlasticSynapseRecord& synapse : image.plastic_synapses) {
    scales.push_back(synapse.scale);
    quanta.push_back(plastic_quanta(synapse.base_quanta, synapse.scale));
    eligibilities.push_back(0);
  }
}

void DenseLearning::tick(std::span<const NeuronId> spikes) {
  has_fired_.emplace_back(image_.header.neuron_count, false);
  for (const NeuronId neuron : spikes) {
    has_fired_.back()[static_cast<std::size_t>(neuron)] = true;
  }
}

void DenseLearning::reward(std::uint64_t tick, const RewardSample& sample) {
  if (tick <= last_tick_) {
    return;
  }
  for (std::size_t p = 0; p < rules_.size(); ++p) {
    move(image_.plasticity[p], rules_[p], tick - last_tick_, sample);
  }
  has_fired_.clear();
  last_tick_ = tick;
}

void DenseLearning::move(const PlasticityRecord& record, Rule& rule, std::uint64_t ticks, const RewardSample& sample) {
  const ProjectionRecord& projection = image_.projections[record.projection];
  const double seconds = static_cast<double>(ticks) * static_cast<double>(image_.header.tick_ns) * 1e-9;
  const double keep_rate = decay(image_, record, 0, ticks);
  const double keep_mean = decay(image_, record, 1, ticks);
  const double keep_eligibility = decay(image_, record, 2, ticks);
  const double keep_reward = decay(image_, record, 3, ticks);
  ++rule.samples;
  const auto trace = [&](std::vector<double>& rate, std::vector<double>& mean, std::uint32_t population) {
    std::vector<double> deviation;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      int spikes = 0;
      for (const std::vector<bool>& fired : has_fired_) {
        spikes += fired[image_.populations[population].first_neuron + i] ? 1 : 0;
      }
      rate[i] = no_dust(rate[i] + gain(keep_rate, rule.samples) * (spikes / seconds - rate[i]));
      mean[i] = no_dust(mean[i] + gain(keep_mean, rule.samples) * (rate[i] - mean[i]));
      deviation.push_back((rate[i] - mean[i]) / record.reference_rate_hz);
    }
    return deviation;
  };
  const std::vector<double> pre = trace(rule.pre_rate, rule.pre_mean, projection.pre_population);
  const std::vector<double> post = trace(rule.post_rate, rule.post_mean, projection.post_population);
  const auto channel = static_cast<std::uint32_t>(record.channel);
  const bool has_reward = ((sample.given >> channel) & 1U) != 0;
  double surprise = 0;
  if (has_reward) {
    rule.expected += gain(keep_reward, ++rule.rewards) * (sample.value[channel] - rule.expected);
    surprise = sample.value[channel] - rule.expected;
  }
  for (std::size_t j = 0; j < pre.size(); ++j) {
    for (std::size_t i = 0; i < post.size(); ++i) {
      const double covariance = pre[j] * post[i];
      double& e = rule.eligibility[j * post.size() + i];
      e = no_dust(keep_eligibility * e + (1.0 - keep_eligibility) * covariance);
      double factor = surprise * e;
      factor = record.form == PlasticityForm::SeedEq2    ? surprise * covariance * e
               : record.form == PlasticityForm::SeedCode ? (1.0 - surprise) * covariance * e
                                                         : factor;
      for (std::uint32_t s = record.first_synapse; s < record.first_synapse + record.synapse_count; ++s) {
        const PlasticSynapseRecord& synapse = image_.plastic_synapses[s];
        if (synapse.pre != j || synapse.post != i) {
          continue;
        }
        eligibilities[s] = e;
        if (has_reward) {
          const double change =
              std::nearbyint(record.learning_rate_hz * seconds * static_cast<double>(kScaleOne) * factor);
          const double moved = std::clamp(scales[s] + std::clamp(change, -0x1p30, 0x1p30),
                                          static_cast<double>(record.lowest), static_cast<double>(record.highest));
          scales[s] = static_cast<std::int32_t>(moved);
          quanta[s] = plastic_quanta(synapse.base_quanta, scales[s]);
        }
      }
    }
  }
}

}  // namespace tectum::test
