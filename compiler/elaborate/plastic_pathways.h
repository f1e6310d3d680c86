// Which synapses learn, and what they have learned before.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/elaborate/network.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// Is the target on this side, or the source where the target has no side?
[[nodiscard]] bool is_on_side(const std::string& side, const Circuit& circuit, const Instance& pre,
                              const Instance& post);

class PlasticPathways {
 public:
  PlasticPathways(const Circuit& circuit, Network& network, Diagnostics& diagnostics)
      : circuit_(circuit), network_(network), diagnostics_(diagnostics) {}

  /// The network's newest pathway, whose synapses begin at `first`, learns in this way if its side is meant.
  void add(const Plasticity& plasticity, const Instance& pre, const Instance& post, std::size_t first);
  /// Factors for pathways that the projection did not make. Call after its last one.
  void report_unused(const Projection& projection);
  /// Makes the columns of what learns as long as the others, if anything learns.
  void finish();

 private:
  void take_factors(const LearnedFactors& learned, std::size_t first);

  const Circuit& circuit_;
  Network& network_;
  Diagnostics& diagnostics_;
  std::vector<std::string> pathways_;  // of the projection in hand that learn
};

}  // namespace tectum
