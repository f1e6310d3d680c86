#include "runtime/learn/plastic_weights.h"

namespace tectum {

std::vector<std::uint32_t> plastic_weight_places(const SpikeImage& image) {
  std::vector<std::uint32_t> places(image.plastic_synapses.size());
  for (const PlasticityRecord& rule : image.plasticity) {
    const PopulationRecord& pre = image.populations[image.projections[rule.projection].pre_population];
    for (std::uint32_t s = rule.first_synapse; s < rule.first_synapse + rule.synapse_count; ++s) {
      const PlasticSynapseRecord& synapse = image.plastic_synapses[s];
      std::uint32_t segment = image.row_begin[pre.first_neuron + synapse.pre];
      while (image.segments[segment + 1].target_begin <= synapse.target) {
        ++segment;
      }
      places[s] = image.segments[segment].weight_begin + (synapse.target - image.segments[segment].target_begin);
    }
  }
  return places;
}

}  // namespace tectum
