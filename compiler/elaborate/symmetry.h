#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "compiler/elaborate/network.h"

namespace tectum {

/// Is the network its own mirror image? One verdict for each pair of sides: all axes of the same two sides are
/// swapped together, because a mirror swaps them together.
struct SymmetryVerdict {
  std::string axes;                    // "horizontal", or "horizontal, eye"; empty: pairs by name alone
  std::string sides;                   // "left/right"
  std::size_t unmatched_synapses = 0;  // that have no mirror image
  std::vector<std::string> broken_by;  // projections, and populations whose neurons differ; in the circuit's order

  [[nodiscard]] bool is_symmetric() const { return broken_by.empty(); }
};

/// The mirror swaps the sides of each population, and populations whose names differ by them ("SC_left", "SC_right");
/// where neurons have places and the sides are left/right or up/down,
/// it also maps each neuron to the one at the mirrored place. Synapses must map onto synapses of the same weight,
/// delay and receptor, and neurons onto neurons of the same parameters. Axes of more than two sides have no mirror.
[[nodiscard]] std::vector<SymmetryVerdict> mirror_symmetry(const Circuit& circuit, const Network& network);

}  // namespace tectum
