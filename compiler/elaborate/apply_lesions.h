#pragma once

#include "compiler/elaborate/network.h"

namespace tectum {

/// Takes lesioned synapses out and marks lesioned neurons as silent. Neurons keep their numbers, so that rasters with
/// and without a lesion compare; random draws keep theirs, so that nothing else changes.
/// Keeps: order of synapses.
void apply_lesions(const Circuit& circuit, Network& network);

}  // namespace tectum
