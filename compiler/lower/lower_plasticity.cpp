#include "compiler/lower/lower_plasticity.h"

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

std::int32_t fixed_scale(double factor) {
  return static_cast<std::int32_t>(std::nearbyint(std::ldexp(factor, kScaleBits)));
}

PlasticityRecord record_of(const PlasticRule& rule, double tick_ms, ImageContents& image) {
  const Plasticity& plasticity = rule.plasticity;
  PlasticityRecord record{};
  record.form = plasticity.form;
  record.channel = rule.channel;
  record.listed_count = rule.listed_count;
  record.first_decay = static_cast<std::uint32_t>(image.decays.size());
  for (const double tau_ms :
       {plasticity.tau_rate_ms, plasticity.tau_mean_ms, plasticity.tau_eligibility_ms, plasticity.tau_reward_ms}) {
    append_decays(tick_ms, tau_ms, image.decays);
  }
  record.learning_rate_hz = plasticity.learning_rate * 1000;
  record.reference_rate_hz = plasticity.reference_rate * 1000;
  record.lowest = fixed_scale(plasticity.lowest);
  record.highest = fixed_scale(plasticity.highest);
  return record;
}

}  // namespace

void append_decays(double tick_ms, double tau_ms, std::vector<double>& decays) {
  for (std::uint32_t k = 0; k < kDecayPowers; ++k) {
    decays.push_back(std::exp(-std::ldexp(tick_ms, static_cast<int>(k)) / tau_ms));
  }
}

void lower_plasticity(const Network& network, const std::vector<std::uint32_t>& target_of,
                      const std::vector<std::uint32_t>& projection_of, ImageContents& image) {
  if (network.rules.empty()) {
    return;
  }
  const Synapses& synapses = network.synapses;
  std::vector<std::vector<std::uint32_t>> of_pathway(network.pathways.size());
  for (std::uint32_t s = 0; s < synapses.size(); ++s) {
    if (network.pathways[synapses.pathway[s]].rule != kNoRule) {
      of_pathway[synapses.pathway[s]].push_back(s);
    }
  }
  for (std::size_t p = 0; p < network.pathways.size(); ++p) {
    const Pathway& pathway = network.pathways[p];
    std::vector<std::uint32_t>& own = of_pathway[p];
    if (own.empty()) {
      continue;  // lesioned
    }
    // Targets ascend from row to row.
    std::sort(own.begin(), own.end(), [&](std::uint32_t a, std::uint32_t b) { return target_of[a] < target_of[b]; });
    PlasticityRecord record = record_of(network.rules[pathway.rule], network.tick_ms(), image);
    record.projection = projection_of[p];
    record.first_synapse = static_cast<std::uint32_t>(image.plastic_synapses.size());
    record.synapse_count = static_cast<std::uint32_t>(own.size());
    image.plasticity.push_back(record);
    for (const std::uint32_t s : own) {
      image.plastic_synapses.push_back({target_of[s],
                                        synapses.pre[s] - network.populations[pathway.pre_population].first_neuron,
                                        synapses.post[s] - network.populations[pathway.post_population].first_neuron,
                                        synapses.ordinal[s], synapses.base_quanta[s], synapses.scale[s]});
    }
  }
}

}  // namespace tectum
