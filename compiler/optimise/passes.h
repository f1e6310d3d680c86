// The passes, each in its own file.
#pragma once

#include "compiler/elaborate/network.h"

namespace tectum {

/// Joins synapses of the same neurons, receptor and delay into one with the summed quanta.
/// Needs: nothing. Keeps: order of first appearance. Drops: the origin of all but the first of each.
/// Exact, because the engine adds quanta as integers.
void merge_parallel_synapses(Network& network);

/// Takes out synapses whose weight is no quantum at all.
/// Needs: nothing. Keeps: order. Exact: they add nothing, and waking a neuron for nothing changes no state.
void drop_empty_synapses(Network& network);

}  // namespace tectum
