// The evaluation of learning as a table and as JSON.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/evaluate/evaluation_text.h"
#include "tools/evaluate/learning_evaluation.h"

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

std::string start_text(double perturbed) {
  return perturbed > 0 ? fmt::format("those onto each side {:g} % too weak or too strong, by a coin", 100 * perturbed)
                       : std::string("weights as declared");
}

std::string phase_row(const LearningResult& result, LearningPhase phase) {
  const ChannelRmse rmse_deg = result.mean_rmse(phase);
  std::string text = fmt::format("  {:<9}", kLearningPhaseNames[static_cast<std::size_t>(phase)]);
  for (const double each_deg : rmse_deg) {
    text += fmt::format("{:7.2f}", each_deg);
  }
  text += fmt::format("{:8.3f}", mean_of(rmse_deg));
  if (phase != LearningPhase::Without) {
    const double before_deg = mean_of(result.mean_rmse(LearningPhase::Without));
    text += fmt::format("{:+9.1f} %{:6} of {}", 100 * (mean_of(rmse_deg) / before_deg - 1), result.better(phase),
                        result.trials.size());
  }
  return text + '\n';
}

}  // namespace

std::string learning_text(const Protocol& protocol, const std::vector<LearningResult>& results) {
  std::string text = fmt::format(
      "protocol {}: {} trials of {:g} s, seeds {} to {}; trained for {:g} s on other targets, seeds from {}\n\n"
      "without: weights stay; learning: they change in the trial; learned: they stay as the training left them\n\n"
      "RMSE (deg)    left h left v right h right v  mean   change  better trials\n",
      protocol.name, protocol.trials, protocol.duration_s, protocol.first_seed,
      protocol.first_seed + static_cast<std::uint64_t>(protocol.trials) - 1, protocol.learning.duration_s,
      protocol.learning.first_seed);
  for (const LearningResult& result : results) {
    text += fmt::format("{}; {}\n", setting_text(result.setting), start_text(result.perturbed));
    for (const LearningPhase phase : {LearningPhase::Without, LearningPhase::Learning, LearningPhase::Learned}) {
      text += phase_row(result, phase);
    }
  }
  return text;
}

std::string learning_json(const Protocol& protocol, const std::string& circuit,
                          const std::vector<LearningResult>& results) {
  Json json = {{"protocol", protocol.name},
               {"circuit", circuit},
               {"trials", protocol.trials},
               {"duration_s", protocol.duration_s},
               {"first_seed", protocol.first_seed},
               {"training_s", protocol.learning.duration_s},
               {"training_first_seed", protocol.learning.first_seed},
               {"results", Json::array()}};
  for (const LearningResult& result : results) {
    Json one = {{"hold_s", result.setting.hold_s},
                {"camera_latency_frames", result.setting.camera_latency_frames},
                {"perturbed", result.perturbed},
                {"learning_better", result.better(LearningPhase::Learning)},
                {"learned_better", result.better(LearningPhase::Learned)},
                {"trials", Json::array()}};
    for (const LearningTrial& trial : result.trials) {
      Json phases;
      for (std::size_t p = 0; p < kLearningPhases; ++p) {
        Json& channels = phases[std::string(kLearningPhaseNames[p]) + "_rmse_deg"];
        for (std::size_t c = 0; c < kChannels; ++c) {
          channels[kChannelNames[c]] = trial.rmse_deg[p][c];
        }
      }
      one["trials"].push_back(std::move(phases));
    }
    json["results"].push_back(std::move(one));
  }
  return json.dump(2);
}

}  // namespace tectum
