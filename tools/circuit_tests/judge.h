// One expectation against one run.
#pragma once

#include <functional>

#include "tools/circuit_tests/measures.h"
#include "tools/circuit_tests/run_tests.h"

namespace tectum {

struct JudgedRun {
  RunFacts& facts;
  std::vector<std::string> names;                             // of the populations
  std::function<const Recording&(const std::string&)> other;  // SameAs: the other circuit's run in the same world
  std::function<void(const std::string& golden)> golden;      // Raster: takes what was seen
  std::string world;                                          // for a golden's first line
};

/// A raster is compared with the golden file as it stands; what the run gave goes to `golden`, passed or not.
[[nodiscard]] SeedOutcome judge(const Expectation& expectation, const JudgedRun& run);

/// By the quantifier: over all seeds, or their mean.
[[nodiscard]] ExpectationResult conclude(const Expectation& expectation, Quantifier quantifier,
                                         std::vector<SeedOutcome> seeds);

}  // namespace tectum
