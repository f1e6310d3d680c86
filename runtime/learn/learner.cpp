#include "runtime/learn/learner.h"

#include <algorithm>
#include <cmath>

#include "runtime/learn/plastic_weights.h"

namespace tectum {
namespace {

/// exp(-h ticks / tau), from its binary digits.
double decay_over(const double* powers, std::uint64_t ticks) noexcept {
  double product = 1;
  const std::uint64_t digits = std::min<std::uint64_t>(ticks, 0xFFFFFFFFU);
  for (std::uint32_t k = 0; k < kDecayPowers; ++k) {
    if (((digits >> k) & 1U) != 0) {
      product *= powers[k];
    }
  }
  return product;
}

double without_dust(double value) noexcept {
  return value < Learner::kSmallest && value > -Learner::kSmallest ? 0.0 : value;
}

/// How far a mean of this memory goes towards its `count`th sample: all of them weigh the same until the memory is
/// full.
double gain_of(double keep, std::uint64_t count) noexcept {
  return std::max(1.0 - keep, 1.0 / static_cast<double>(count));
}

}  // namespace

Learner::Learner(const SpikeImage& image)
    : image_(image),
      spike_counts_(image.header.neuron_count, 0),
      weight_of_(plastic_weight_places(image)),
      scales_(image.plastic_synapses.size()),
      eligibilities_(image.plastic_synapses.size()) {
  for (const PlasticityRecord& record : image_.plasticity) {
    const ProjectionRecord& projection = image_.projections[record.projection];
    const PopulationRecord& pre = image_.populations[projection.pre_population];
    const PopulationRecord& post = image_.populations[projection.post_population];
    Rule& rule = rules_.emplace_back();
    rule.record = record;
    rule.first_pre_neuron = pre.first_neuron;
    rule.first_post_neuron = post.first_neuron;
    rule.pre_size = pre.size;
    rule.post_size = post.size;
    rule.pre.resize(pre.size);
    rule.post.resize(post.size);
    for (std::uint32_t s = record.first_synapse; s < record.first_synapse + record.synapse_count; ++s) {
      const PlasticSynapseRecord& synapse = image_.plastic_synapses[s];
      if (rule.rows.empty() || rule.rows.back().pre != synapse.pre) {
        rule.rows.push_back({synapse.pre, s, s, false});
      }
      rule.rows.back().end = s + 1;
    }
  }
  reset();
}

void Learner::reset() noexcept {
  std::fill(spike_counts_.begin(), spike_counts_.end(), 0U);
  std::fill(eligibilities_.begin(), eligibilities_.end(), 0.0);
  for (std::size_t s = 0; s < scales_.size(); ++s) {
    scales_[s] = image_.plastic_synapses[s].scale;
  }
  for (Rule& rule : rules_) {
    std::fill(rule.pre.begin(), rule.pre.end(), RateTrace{});
    std::fill(rule.post.begin(), rule.post.end(), RateTrace{});
    for (Row& row : rule.rows) {
      row.is_awake = false;
    }
    rule.samples = 0;
    rule.rewards = 0;
    rule.expected_reward = 0;
  }
  last_tick_ = 0;
  rows_visited_ = 0;
}

Learner::Step Learner::step_of(const Rule& rule, std::uint64_t ticks) const noexcept {
  const double* const powers = image_.decays.data() + rule.record.first_decay;
  return {static_cast<double>(ticks) * static_cast<double>(image_.header.tick_ns) * 1e-9, decay_over(powers, ticks),
          decay_over(powers + kDecayPowers, ticks), decay_over(powers + 2 * kDecayPowers, ticks),
          decay_over(powers + 3 * kDecayPowers, ticks)};
}

void Learner::move_traces(std::vector<RateTrace>& traces, std::uint32_t first_neuron, const Rule& rule,
                          const Step& step) const noexcept {
  const double rate_gain = gain_of(step.keep_rate, rule.samples);
  const double mean_gain = gain_of(step.keep_mean, rule.samples);
  for (std::uint32_t i = 0; i < traces.size(); ++i) {
    RateTrace& trace = traces[i];
    const std::uint32_t spikes = spike_counts_[first_neuron + i];
    if (spikes == 0 && trace.rate_hz == 0 && trace.mean_hz == 0) {
      continue;
    }
    const double now_hz = static_cast<double>(spikes) / step.seconds;
    trace.rate_hz = without_dust(trace.rate_hz + rate_gain * (now_hz - trace.rate_hz));
    trace.mean_hz = without_dust(trace.mean_hz + mean_gain * (trace.rate_hz - trace.mean_hz));
    trace.deviation = (trace.rate_hz - trace.mean_hz) / rule.record.reference_rate_hz;
  }
}

/// M: the reward minus what was expected of it; nothing when there was no reward.
std::optional<double> Learner::surprise(Rule& rule, const Step& step, const RewardSample& reward) noexcept {
  constexpr double kLargestReward = 1e6;
  const auto channel = static_cast<std::uint32_t>(rule.record.channel);
  const double value = reward.value[channel];
  if (((reward.given >> channel) & 1U) == 0 || !(std::abs(value) <= kLargestReward)) {
    return std::nullopt;
  }
  ++rule.rewards;
  rule.expected_reward += gain_of(step.keep_reward, rule.rewards) * (value - rule.expected_reward);
  return value - rule.expected_reward;
}

void Learner::move_row(const Rule& rule, Row& row, const Step& step, std::optional<double> surprise,
                       std::span<std::int32_t> weights) noexcept {
  const double pre = rule.pre[row.pre].deviation;
  if (pre == 0 && !row.is_awake) {
    return;
  }
  ++rows_visited_;
  const PlasticityForm form = rule.record.form;
  const double scale_a_step = rule.record.learning_rate_hz * step.seconds * static_cast<double>(kScaleOne);
  constexpr double kMostAStep = static_cast<double>(std::int32_t{1} << 30);
  row.is_awake = false;
  for (std::uint32_t s = row.begin; s < row.end; ++s) {
    const PlasticSynapseRecord& synapse = image_.plastic_synapses[s];
    const double covariance = pre * rule.post[synapse.post].deviation;
    const double eligibility =
        without_dust(step.keep_eligibility * eligibilities_[s] + (1.0 - step.keep_eligibility) * covariance);
    eligibilities_[s] = eligibility;
    row.is_awake = row.is_awake || eligibility != 0;
    if (!surprise) {
      continue;
    }
    const double factor = form == PlasticityForm::ThreeFactor ? *surprise * eligibility
                          : form == PlasticityForm::SeedEq2   ? *surprise * covariance * eligibility
                                                              : (1.0 - *surprise) * covariance * eligibility;
    const double wanted = std::nearbyint(scale_a_step * factor);
    const double change = wanted > kMostAStep ? kMostAStep : wanted < -kMostAStep ? -kMostAStep : wanted;
    if (change == 0) {
      continue;
    }
    const std::int64_t moved = std::int64_t{scales_[s]} + static_cast<std::int64_t>(change);
    scales_[s] = static_cast<std::int32_t>(std::clamp<std::int64_t>(moved, rule.record.lowest, rule.record.highest));
    weights[weight_of_[s]] = plastic_quanta(synapse.base_quanta, scales_[s]);
  }
}

void Learner::take_reward(std::uint64_t tick, const RewardSample& reward, std::span<std::int32_t> weights) noexcept {
  if (tick <= last_tick_) {
    return;
  }
  const std::uint64_t ticks = tick - last_tick_;
  last_tick_ = tick;
  rows_visited_ = 0;
  for (Rule& rule : rules_) {
    const Step step = step_of(rule, ticks);
    ++rule.samples;
    move_traces(rule.pre, rule.first_pre_neuron, rule, step);
    move_traces(rule.post, rule.first_post_neuron, rule, step);
    const std::optional<double> surprise_now = surprise(rule, step, reward);
    for (Row& row : rule.rows) {
      move_row(rule, row, step, surprise_now, weights);
    }
  }
  std::fill(spike_counts_.begin(), spike_counts_.end(), 0U);
}

}  // namespace tectum
