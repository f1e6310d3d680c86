#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "compiler/elaborate/can_fire.h"
#include "compiler/optimise/keep_synapses.h"
#include "compiler/optimise/passes.h"

namespace tectum {

std::string drop_mute_synapses(Network& network) {
  const std::vector<bool> can_fire = neurons_that_can_fire(network);
  const auto mute_count = std::count(can_fire.begin(), can_fire.end(), false);
  if (mute_count > 0) {
    std::vector<bool> keep(network.synapses.size());
    for (std::size_t s = 0; s < keep.size(); ++s) {
      const bool learns = network.pathways[network.synapses.pathway[s]].rule != kNoRule;
      keep[s] = can_fire[network.synapses.pre[s]] || learns;  // weights that learn are read out
    }
    keep_synapses(keep, network.synapses);
  }
  return fmt::format("{} of {} neurons can never fire", mute_count, network.neuron_count());
}

}  // namespace tectum
