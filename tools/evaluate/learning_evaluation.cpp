#include "tools/evaluate/learning_evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>

#include "runtime/learn/plastic_weights.h"
#include "tools/analysis/tracking_metrics.h"
#include "tools/evaluate/parallel_jobs.h"

namespace tectum {
namespace {

ChannelRmse rmse_of(const Recording& recording) {
  const TrackingMetrics metrics = tracking_metrics(recording);
  ChannelRmse rmse_deg{};
  for (std::size_t c = 0; c < kChannels; ++c) {
    rmse_deg[c] = channel_of(metrics, c).all.rmse_deg;
  }
  return rmse_deg;
}

using Report = std::function<void(double)>;

LearningTrial run_trial(const SpikeImage& image, const Protocol& protocol, const Setting& setting, std::uint64_t trial,
                        const Report& report) {
  LearningTrial result;
  int done = 0;
  const auto run = [&](const SpikeImage& started, const SimulatedRunOptions& options, std::vector<std::int32_t>* to) {
    RunObserver observer;
    observer.progress = [&](double share) { report((done + share) / 4); };
    observer.learned = [&](std::span<const std::int32_t> scales) {
      if (to != nullptr) {
        to->assign(scales.begin(), scales.end());
      }
    };
    Recording recording = run_simulated_head(started, options, observer);
    ++done;
    return recording;
  };
  SimulatedRunOptions options = trial_options(image, protocol, setting, protocol.first_seed + trial);
  const auto place = [&](LearningPhase phase) -> ChannelRmse& {
    return result.rmse_deg[static_cast<std::size_t>(phase)];
  };
  place(LearningPhase::Without) = rmse_of(run(image, options, nullptr));
  options.learns = true;
  place(LearningPhase::Learning) = rmse_of(run(image, options, nullptr));
  SimulatedRunOptions training = trial_options(image, protocol, setting, protocol.learning.first_seed + trial);
  training.duration_s = protocol.learning.duration_s;
  training.learns = true;
  std::vector<std::int32_t> scales;
  (void)run(image, training, &scales);
  options.learns = false;
  place(LearningPhase::Learned) = rmse_of(run(with_scales(image, scales), options, nullptr));
  return result;
}

}  // namespace

SpikeImage with_scales(const SpikeImage& image, std::span<const std::int32_t> scales) {
  struct Own {
    std::shared_ptr<const void> base;
    std::vector<std::int32_t> weights;
    std::vector<PlasticSynapseRecord> synapses;
  };
  auto own = std::make_shared<Own>();
  own->base = image.storage;
  own->weights.assign(image.weights.begin(), image.weights.end());
  own->synapses.assign(image.plastic_synapses.begin(), image.plastic_synapses.end());
  const std::vector<std::uint32_t> places = plastic_weight_places(image);
  for (std::size_t s = 0; s < own->synapses.size(); ++s) {
    own->synapses[s].scale = scales[s];
    own->weights[places[s]] = plastic_quanta(own->synapses[s].base_quanta, scales[s]);
  }
  SpikeImage changed = image;
  changed.weights = own->weights;
  changed.plastic_synapses = own->synapses;
  changed.storage = std::move(own);
  return changed;
}

std::vector<std::int32_t> perturbed_scales(const SpikeImage& image, double share, std::uint64_t seed) {
  std::vector<std::int32_t> scales(image.plastic_synapses.size());
  std::mt19937_64 random(seed);
  std::map<std::uint32_t, double> factor_onto;  // by target population
  for (const PlasticityRecord& rule : image.plasticity) {
    const auto [place, is_new] = factor_onto.try_emplace(image.projections[rule.projection].post_population, 0.0);
    if (is_new) {
      place->second = (random() >> 63U) == 0 ? 1 - share : 1 + share;
    }
    const double factor = place->second;
    for (std::uint32_t s = rule.first_synapse; s < rule.first_synapse + rule.synapse_count; ++s) {
      const double wanted = std::nearbyint(factor * image.plastic_synapses[s].scale);
      scales[s] = static_cast<std::int32_t>(
          std::clamp(wanted, static_cast<double>(rule.lowest), static_cast<double>(rule.highest)));
    }
  }
  return scales;
}

double mean_of(const ChannelRmse& rmse_deg) {
  return std::accumulate(rmse_deg.begin(), rmse_deg.end(), 0.0) / static_cast<double>(kChannels);
}

ChannelRmse LearningResult::mean_rmse(LearningPhase phase) const {
  ChannelRmse sum{};
  for (const LearningTrial& trial : trials) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      sum[c] += trial.of(phase)[c] / static_cast<double>(trials.size());
    }
  }
  return sum;
}

std::size_t LearningResult::better(LearningPhase phase) const {
  return static_cast<std::size_t>(std::count_if(trials.begin(), trials.end(), [&](const LearningTrial& trial) {
    return mean_of(trial.of(phase)) < mean_of(trial.of(LearningPhase::Without));
  }));
}

std::vector<LearningResult> evaluate_learning(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                              const std::function<void(double)>& progress) {
  std::vector<LearningResult> results;
  for (const Setting& setting : settings_of(protocol)) {
    for (const double perturbed : protocol.learning.perturbed) {
      results.push_back({setting, perturbed, {}});
      results.back().trials.resize(static_cast<std::size_t>(protocol.trials));
    }
  }
  std::vector<Job> jobs;
  for (LearningResult& result : results) {
    for (std::size_t trial = 0; trial < result.trials.size(); ++trial) {
      jobs.emplace_back([&image, &protocol, &result, trial](const Report& report) {
        const SpikeImage start =
            with_scales(image, perturbed_scales(image, result.perturbed, protocol.first_seed + trial));
        result.trials[trial] = run_trial(start, protocol, result.setting, trial, report);
      });
    }
  }
  run_jobs(jobs, threads, progress);
  return results;
}

}  // namespace tectum
