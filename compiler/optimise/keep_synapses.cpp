#include "compiler/optimise/keep_synapses.h"

namespace tectum {

void keep_synapses(const std::vector<bool>& keep, Synapses& synapses) {
  std::size_t kept = 0;
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    if (keep[s]) {
      synapses.pre[kept] = synapses.pre[s];
      synapses.post[kept] = synapses.post[s];
      synapses.quanta[kept] = synapses.quanta[s];
      synapses.delay_ticks[kept] = synapses.delay_ticks[s];
      synapses.pathway[kept] = synapses.pathway[s];
      ++kept;
    }
  }
  synapses.pre.resize(kept);
  synapses.post.resize(kept);
  synapses.quanta.resize(kept);
  synapses.delay_ticks.resize(kept);
  synapses.pathway.resize(kept);
}

}  // namespace tectum
