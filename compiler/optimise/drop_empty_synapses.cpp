#include "compiler/optimise/keep_synapses.h"
#include "compiler/optimise/passes.h"

namespace tectum {

void drop_empty_synapses(Network& network) {
  std::vector<bool> keep(network.synapses.size());
  for (std::size_t s = 0; s < network.synapses.size(); ++s) {
    const bool may_grow = !network.synapses.base_quanta.empty() && network.synapses.base_quanta[s] != 0;
    keep[s] = network.synapses.quanta[s] != 0 || may_grow;
  }
  keep_synapses(keep, network.synapses);
}

}  // namespace tectum
