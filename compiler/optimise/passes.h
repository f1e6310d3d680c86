// The passes, each in its own file. Each returns a few words on what it did, for --stats.
#pragma once

#include <string>

#include "compiler/elaborate/network.h"

namespace tectum {

/// Takes out the synapses of neurons that can never fire: those that rest below threshold and that no neuron reaches
/// which can fire, Poisson neurons of rate 0, and spike lists without a spike.
/// Needs: nothing. Keeps: order, neurons, and with them probes and outputs. Exact as long as nobody injects spikes into
/// such a neuron, which no command does; an image for that is compiled with -O1.
std::string drop_mute_synapses(Network& network);

/// Joins synapses of the same neurons, receptor and delay into one with the summed quanta.
/// Needs: nothing. Keeps: order of first appearance. Drops: the origin of all but the first of each.
/// Exact, because the engine adds quanta as integers.
std::string merge_parallel_synapses(Network& network);

/// Takes out synapses whose weight is no quantum at all.
/// Needs: merged synapses, whose weights may have cancelled. Keeps: order.
/// Exact: they add nothing, and waking a neuron for nothing changes no state.
std::string drop_empty_synapses(Network& network);

/// Lets the image store one weight for all synapses of a neuron with the same delay, where it is the same.
/// Needs: quanta that no later pass changes. Keeps: every synapse.
std::string share_constant_weights(Network& network);

/// Chooses the order in which populations lie in the engine's memory, and are updated within a tick, so that what
/// one neuron reaches lies close together. Same-tick synapses go before it.
/// Needs: synapses that no later pass takes out. Keeps: the numbers of neurons, hence rasters, probes, and every random
/// draw.
std::string renumber_for_locality(Network& network);

}  // namespace tectum
