#pragma once

#include "compiler/elaborate/network.h"
#include "runtime/image/image_contents.h"

namespace tectum {

/// Lays the network out as an image: update order, slots, CSR rows by presynaptic neuron sorted by (delay, slot),
/// and the propagators. Cannot fail. The same network gives the same contents.
[[nodiscard]] ImageContents lower(const Network& network);

}  // namespace tectum
