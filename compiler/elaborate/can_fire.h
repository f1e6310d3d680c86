#pragma once

#include <vector>

#include "compiler/elaborate/network.h"

namespace tectum {

/// Which neurons can fire at all: those that do so by themselves, and every neuron that one of these reaches. Where it
/// is not sure, as of models with equations of their own, a neuron counts as able to fire.
[[nodiscard]] std::vector<bool> neurons_that_can_fire(const Network& network);

}  // namespace tectum
