#include "compiler/elaborate/apply_lesions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "compiler/expression/random_stream.h"

namespace tectum {
namespace {

void silence_instances(const Circuit& circuit, const Lesion& lesion, std::vector<bool>& is_silent, Network& network) {
  for (const InstanceId id : lesion.instances) {
    NetworkPopulation& population = network.populations[index_of(id)];
    const RandomStream random(circuit.seed, "lesion\n" + lesion.key + "\n" + population.name);
    for (std::uint32_t i = 0; i < population.size; ++i) {
      if (random.uniform(i) < lesion.fraction) {
        is_silent[population.first_neuron + i] = true;
      }
    }
  }
}

/// True for the pathways that the lesion names.
std::vector<bool> lesioned_pathways(const Lesion& lesion, const Network& network) {
  std::vector<bool> is_cut(network.pathways.size(), false);
  for (std::size_t p = 0; p < network.pathways.size(); ++p) {
    const Pathway& pathway = network.pathways[p];
    const bool is_named =
        std::find(lesion.projections.begin(), lesion.projections.end(), pathway.projection) != lesion.projections.end();
    const std::pair ends(static_cast<InstanceId>(pathway.pre_population),
                         static_cast<InstanceId>(pathway.post_population));
    is_cut[p] = is_named || std::find(lesion.pathways.begin(), lesion.pathways.end(), ends) != lesion.pathways.end();
  }
  return is_cut;
}

/// True for the pathways that come from what the lesion names.
std::vector<bool> outgoing_pathways(const Lesion& lesion, const Network& network) {
  std::vector<bool> is_named = lesioned_pathways(lesion, network);
  for (std::size_t p = 0; p < network.pathways.size(); ++p) {
    const auto pre = static_cast<InstanceId>(network.pathways[p].pre_population);
    is_named[p] =
        is_named[p] || std::find(lesion.instances.begin(), lesion.instances.end(), pre) != lesion.instances.end();
  }
  return is_named;
}

/// Leaves each synapse, or a random fraction of them, this share of its weight, to the nearest quantum.
void weaken(const Circuit& circuit, const Lesion& lesion, Network& network) {
  const std::vector<bool> is_weak = outgoing_pathways(lesion, network);
  const RandomStream random(circuit.seed, "lesion\n" + lesion.key);
  Synapses& synapses = network.synapses;
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    if (is_weak[synapses.pathway[s]] && random.uniform(s) < lesion.fraction) {
      synapses.quanta[s] = static_cast<std::int32_t>(std::nearbyint(synapses.quanta[s] * *lesion.weaken_to));
    }
  }
}

template <typename T>
void keep_marked(std::vector<T>& column, const std::vector<bool>& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (keep[i]) {
      column[kept++] = column[i];
    }
  }
  column.resize(kept);
}

}  // namespace

void apply_lesions(const Circuit& circuit, Network& network) {
  if (circuit.lesions.empty()) {
    return;
  }
  Synapses& synapses = network.synapses;
  std::vector<bool> is_silent(network.neuron_count(), false);
  std::vector<bool> keep(synapses.size(), true);
  for (const Lesion& lesion : circuit.lesions) {
    if (lesion.weaken_to) {
      weaken(circuit, lesion, network);
      continue;
    }
    silence_instances(circuit, lesion, is_silent, network);
    const std::vector<bool> is_cut = lesioned_pathways(lesion, network);
    const RandomStream random(circuit.seed, "lesion\n" + lesion.key);
    for (std::size_t s = 0; s < synapses.size(); ++s) {
      if (is_cut[synapses.pathway[s]] && random.uniform(s) < lesion.fraction) {
        keep[s] = false;
      }
    }
  }
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    keep[s] = keep[s] && !is_silent[synapses.pre[s]] && !is_silent[synapses.post[s]];
  }
  keep_marked(synapses.pre, keep);
  keep_marked(synapses.post, keep);
  keep_marked(synapses.delay_ticks, keep);
  keep_marked(synapses.pathway, keep);
  keep_marked(synapses.quanta, keep);
  keep_marked(synapses.base_quanta, keep);
  keep_marked(synapses.scale, keep);
  keep_marked(synapses.ordinal, keep);
  for (NetworkPopulation& population : network.populations) {
    for (std::uint32_t i = 0; i < population.size; ++i) {
      if (is_silent[population.first_neuron + i]) {
        population.silenced_neurons.push_back(i);
      }
    }
  }
}

}  // namespace tectum
