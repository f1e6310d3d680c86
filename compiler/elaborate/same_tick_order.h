#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compiler/elaborate/network.h"

namespace tectum {

/// Populations in an order in which every same-tick synapse leads forward, among the free the first in the
/// network's layout;
/// or, when there is none, the pathways of one cycle.
struct SameTickOrder {
  std::vector<std::uint32_t> populations;
  std::vector<std::uint32_t> cycle;  // pathway indices, empty when there is an order
};

[[nodiscard]] SameTickOrder same_tick_order(const Network& network);

}  // namespace tectum
