// A made-up run with saccadic tracking, a helping neck and populations that fire as their names suggest.
#pragma once

#include "runtime/record/recording.h"

namespace tectum {

struct SyntheticOptions {
  double duration_s = 60;
  unsigned seed = 1;
  bool has_truth = true;
};

[[nodiscard]] Recording synthetic_recording(const SyntheticOptions& options = {});

}  // namespace tectum
