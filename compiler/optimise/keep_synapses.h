#pragma once

#include <vector>

#include "compiler/elaborate/network.h"

namespace tectum {

/// Cuts the columns down to the marked synapses. Keeps: order.
void keep_synapses(const std::vector<bool>& keep, Synapses& synapses);

}  // namespace tectum
