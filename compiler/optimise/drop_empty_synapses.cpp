#include <algorithm>
#include <cstdint>

#include "compiler/optimise/keep_synapses.h"
#include "compiler/optimise/passes.h"

namespace tectum {

std::string drop_empty_synapses(Network& network) {
  const std::vector<std::int32_t>& quanta = network.synapses.quanta;
  if (std::find(quanta.begin(), quanta.end(), 0) == quanta.end()) {
    return "";
  }
  std::vector<bool> keep(network.synapses.size());
  for (std::size_t s = 0; s < network.synapses.size(); ++s) {
    const bool may_grow = !network.synapses.base_quanta.empty() && network.synapses.base_quanta[s] != 0;
    keep[s] = network.synapses.quanta[s] != 0 || may_grow;
  }
  keep_synapses(keep, network.synapses);
  return "";
}

}  // namespace tectum
