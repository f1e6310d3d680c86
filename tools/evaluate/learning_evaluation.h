// What learning is worth: the same trials without it, with it, and after it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "runtime/image/load_image.h"
#include "tools/evaluate/protocol.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {

/// The image with its plastic weights at these factors of the declared ones (2^-kScaleBits, one a plastic synapse). Its
/// checksum stays the old one's.
[[nodiscard]] SpikeImage with_scales(const SpikeImage& image, std::span<const std::int32_t> scales);

/// The image's own factors, all those onto one side of a population times 1 - share or 1 + share, by a coin, within
/// their bounds. Deterministic in the seed.
[[nodiscard]] std::vector<std::int32_t> perturbed_scales(const SpikeImage& image, double share, std::uint64_t seed);

/// RMSE of each channel, degrees.
using ChannelRmse = std::array<double, kChannels>;
[[nodiscard]] double mean_of(const ChannelRmse& rmse_deg);

enum class LearningPhase {
  Without,   // weights stay
  Learning,  // they change during the trial
  Learned,   // they stay as the training before has left them
};
inline constexpr std::size_t kLearningPhases = 3;
inline constexpr std::array<const char*, kLearningPhases> kLearningPhaseNames = {"without", "learning", "learned"};

struct LearningTrial {
  std::array<ChannelRmse, kLearningPhases> rmse_deg{};
  [[nodiscard]] const ChannelRmse& of(LearningPhase phase) const { return rmse_deg[static_cast<std::size_t>(phase)]; }
};

/// Trials of one setting from one start.
struct LearningResult {
  Setting setting;
  double perturbed = 0;  // share
  std::vector<LearningTrial> trials;

  [[nodiscard]] ChannelRmse mean_rmse(LearningPhase phase) const;
  /// Trials whose mean RMSE over the channels is below the same trial's without learning.
  [[nodiscard]] std::size_t better(LearningPhase phase) const;
};

/// Needs: an image that learns. Deterministic in image and protocol.
[[nodiscard]] std::vector<LearningResult> evaluate_learning(const SpikeImage& image, const Protocol& protocol,
                                                            unsigned threads,
                                                            const std::function<void(double)>& progress);

/// Ends in a newline.
[[nodiscard]] std::string learning_text(const Protocol& protocol, const std::vector<LearningResult>& results);
/// Stable keys. Does not end in a newline.
[[nodiscard]] std::string learning_json(const Protocol& protocol, const std::string& circuit,
                                        const std::vector<LearningResult>& results);

}  // namespace tectum
