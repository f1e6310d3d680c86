#include "compiler/optimise/keep_synapses.h"

namespace tectum {

namespace {

/// Columns of what is not there are empty.
template <typename T>
void keep_marked(const std::vector<bool>& keep, std::vector<T>& column) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (keep[i]) {
      column[kept++] = column[i];
    }
  }
  column.resize(kept);
}

}  // namespace

void keep_synapses(const std::vector<bool>& keep, Synapses& synapses) {
  keep_marked(keep, synapses.pre);
  keep_marked(keep, synapses.post);
  keep_marked(keep, synapses.quanta);
  keep_marked(keep, synapses.delay_ticks);
  keep_marked(keep, synapses.pathway);
  keep_marked(keep, synapses.base_quanta);
  keep_marked(keep, synapses.scale);
  keep_marked(keep, synapses.ordinal);
}

}  // namespace tectum
