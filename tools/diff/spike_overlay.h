// Two recordings' spikes over each other: which are both's, and which one's alone.
#pragma once

#include <string>
#include <vector>

#include "tools/diff/behaviour.h"
#include "tools/report/lane_plot.h"

namespace tectum {

class SpikeOverlay {
 public:
  /// At most `most_populations`: those that the first difference reaches first, then the most different ones.
  SpikeOverlay(const CircuitView& a, const CircuitView& b, const StructureDiff& structure, const Behaviour& behaviour,
               std::size_t most_populations);
  [[nodiscard]] bool is_empty() const { return either_.populations.empty(); }
  [[nodiscard]] std::string picture(const LanePlotOptions& options, const std::string& description) const;

 private:
  Recording both_, only_a_, only_b_, either_;
  std::vector<PopulationSummary> summaries_;
};

}  // namespace tectum
