#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "compiler/elaborate/network.h"
#include "runtime/image/models.h"

namespace tectum {

std::string dump_network(const Network& network, std::size_t max_synapses) {
  std::string text = fmt::format("network {}: {} neurons, {} synapses, tick {} ns, seed {}\n", network.name,
                                 network.neuron_count(), network.synapses.size(), network.tick_ns, network.seed);
  for (const NetworkPopulation& population : network.populations) {
    text +=
        fmt::format("population {}: {} neurons from {}, {}", population.name, population.size, population.first_neuron,
                    population.user_model ? population.user_model->info.name : find_model(population.model)->name);
    for (std::size_t r = 0; r < population.receptors.size(); ++r) {
      text += fmt::format(", {} in 2^{}", population.receptors[r].name, population.quantum_log2[r]);
    }
    if (!population.silenced_neurons.empty()) {
      text += fmt::format(", {} silenced", population.silenced_neurons.size());
    }
    text += '\n';
  }
  if (network.shares_constant_weights) {
    text += "weights: one for a run of equal ones\n";
  }
  if (!network.layout_rank.empty()) {
    std::vector<std::string> names(network.populations.size());
    for (std::size_t p = 0; p < names.size(); ++p) {
      names[network.layout_rank[p]] = network.populations[p].name;
    }
    text += fmt::format("layout: {}\n", fmt::join(names, ", "));
  }
  std::vector<std::size_t> counts(network.pathways.size(), 0);
  for (const std::uint32_t pathway : network.synapses.pathway) {
    ++counts[pathway];
  }
  for (std::size_t p = 0; p < network.pathways.size(); ++p) {
    const Pathway& pathway = network.pathways[p];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    text += fmt::format("pathway {}: {} -> {} {}, {} synapses", pathway.name,
                        network.populations[pathway.pre_population].name, post.name,
                        post.receptors[pathway.receptor].name, counts[p]);
    if (pathway.rule != kNoRule) {
      const PlasticRule& rule = network.rules[pathway.rule];
      text += fmt::format(", learns {} by {}", kPlasticityFormNames[static_cast<std::size_t>(rule.plasticity.form)],
                          kRewardChannelNames[static_cast<std::size_t>(rule.channel)]);
    }
    text += '\n';
  }
  const std::size_t shown = std::min(max_synapses, network.synapses.size());
  for (std::size_t s = 0; s < shown; ++s) {
    const Pathway& pathway = network.pathways[network.synapses.pathway[s]];
    const NetworkPopulation& pre = network.populations[pathway.pre_population];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    const double weight = std::ldexp(network.synapses.quanta[s], post.quantum_log2[pathway.receptor]);
    text +=
        fmt::format("synapse {}[{}] -> {}[{}] {} weight {:.9g} delay {} ticks\n", pre.name,
                    network.synapses.pre[s] - pre.first_neuron, post.name, network.synapses.post[s] - post.first_neuron,
                    post.receptors[pathway.receptor].name, weight, network.synapses.delay_ticks[s]);
  }
  if (shown < network.synapses.size() && shown > 0) {
    text += fmt::format("... and {} more\n", network.synapses.size() - shown);
  }
  return text;
}

}  // namespace tectum
