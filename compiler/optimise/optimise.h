// Network → Network: small passes in a fixed order. None changes a raster.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/elaborate/network.h"

namespace tectum {

/// O0 runs no pass; O2 runs all.
enum class OptimisationLevel { O0 = 0, O1 = 1, O2 = 2 };

struct PassInfo {
  std::string_view name;
  std::string_view what;  // one line
  OptimisationLevel from;
  std::string (*run)(Network&);  // returns a few words on what it did, or nothing
};

/// In the order in which they run.
[[nodiscard]] std::span<const PassInfo> all_passes();

/// What a pass did.
struct PassStats {
  std::string name;
  std::size_t synapses_before = 0;
  std::size_t synapses_after = 0;
  double seconds = 0;
  std::string note;  // what else is to say, or nothing
};

/// Runs the passes of `level`; stops after the pass named `stop_after`, when that is not empty.
std::vector<PassStats> optimise(Network& network, OptimisationLevel level, std::string_view stop_after = {});

}  // namespace tectum
