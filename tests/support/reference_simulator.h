// The semantics of time, written as plainly as possible: dense, in double, no sleeping, no tables,
// no fixed-point weights. What the engine must agree with.
#pragma once

#include <vector>

#include "tests/support/test_network.h"

namespace tectum::test {

struct ReferenceRun {
  Raster raster;
  std::vector<std::vector<double>> v_mv;  // [tick][neuron] after the tick; 0 for models without a membrane
};

/// Needs: no poisson and no field populations.
[[nodiscard]] ReferenceRun run_reference(const TestNetwork& network, std::uint64_t ticks);

}  // namespace tectum::test
