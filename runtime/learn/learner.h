// What learns in a circuit while it runs: the traces of spikes, the expectation of the reward, the weights.
//
// A spike is one count in a cell of its neuron. Everything else happens when a reward comes, in the steps that
// runtime/image/plasticity.h writes down, and only for presynaptic neurons that have something to tell: a row whose
// neuron is silent, and has been for so long that its rates and all its eligibilities are 0, costs nothing. Magnitudes
// below kSmallest count as 0, so that this comes about. The same sums in the same order as a sweep over everything:
// which rows are skipped changes no bit.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/image/load_image.h"

namespace tectum {

/// One sample of the reward, channel by channel.
struct RewardSample {
  std::array<double, kRewardChannelCount> value{};
  std::uint32_t given = 0;  // bit = RewardChannel: it has a value
};

class Learner {
 public:
  /// Rates in Hz, and eligibilities.
  static constexpr double kSmallest = 0x1.0p-40;

  /// Not real-time safe. `image` is copied by value; its storage is shared.
  explicit Learner(const SpikeImage& image);

  /// Back to the initial weights, no spike or reward seen yet. The caller's weights are not touched. Real-time safe.
  void reset() noexcept;

  /// Neurons that fired in a tick. Real-time safe.
  void take_spikes(std::span<const NeuronId> spikes) noexcept {
    for (const NeuronId neuron : spikes) {
      ++spike_counts_[static_cast<std::uint32_t>(neuron)];
    }
  }

  /// A reward at the start of `tick`: one step of the rule over the ticks since the last one, whose new weights are
  /// written into `weights`, in the order of SpikeImage::weights. A value that is no number, or beyond a
  /// million, counts as not given; a second sample in one tick is ignored. Real-time safe.
  void take_reward(std::uint64_t tick, const RewardSample& reward, std::span<std::int32_t> weights) noexcept;

  /// Factor on the declared weight of each plastic synapse, in 2^-kScaleBits.
  [[nodiscard]] std::span<const std::int32_t> scales() const noexcept { return scales_; }
  [[nodiscard]] std::int32_t initial_scale(std::size_t synapse) const noexcept {
    return image_.plastic_synapses[synapse].scale;
  }
  [[nodiscard]] std::span<const double> eligibilities() const noexcept { return eligibilities_; }
  /// Rows that the last reward went through, of all rules.
  [[nodiscard]] std::uint64_t rows_visited() const noexcept { return rows_visited_; }

 private:
  /// Of one neuron in one rule.
  struct RateTrace {
    double rate_hz = 0;
    double mean_hz = 0;
    double deviation = 0;  // (rate - mean) / r0
  };
  struct Row {
    std::uint32_t pre;    // in its population
    std::uint32_t begin;  // of plastic synapses
    std::uint32_t end;
    bool is_awake;  // some eligibility is not 0
  };
  struct Rule {
    PlasticityRecord record;
    std::uint32_t first_pre_neuron, pre_size;
    std::uint32_t first_post_neuron, post_size;
    std::vector<RateTrace> pre, post;
    std::vector<Row> rows;  // of presynaptic neurons that have plastic synapses
    std::uint64_t samples = 0;
    double expected_reward = 0;
    std::uint64_t rewards = 0;
  };
  struct Step {
    double seconds;
    double keep_rate, keep_mean, keep_eligibility, keep_reward;
  };

  [[nodiscard]] Step step_of(const Rule& rule, std::uint64_t ticks) const noexcept;
  void move_traces(std::vector<RateTrace>& traces, std::uint32_t first_neuron, const Rule& rule,
                   const Step& step) const noexcept;
  [[nodiscard]] static std::optional<double> surprise(Rule& rule, const Step& step,
                                                      const RewardSample& reward) noexcept;
  void move_row(const Rule& rule, Row& row, const Step& step, std::optional<double> surprise,
                std::span<std::int32_t> weights) noexcept;

  SpikeImage image_;
  std::vector<std::uint32_t> spike_counts_;  // [neuron], since the last reward
  std::vector<Rule> rules_;
  std::vector<std::uint32_t> weight_of_;  // [plastic synapse] index into the weights
  std::vector<std::int32_t> scales_;
  std::vector<double> eligibilities_;
  std::uint64_t last_tick_ = 0;
  std::uint64_t rows_visited_ = 0;
};

}  // namespace tectum
