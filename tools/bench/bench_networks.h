// The benchmark networks, built in code: what circuits/bench/*.json compile to.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/image/image_contents.h"

namespace tectum::bench {

struct BenchNetwork {
  std::string_view name;
  std::string_view what;
  double duration_s;
  std::uint32_t ticks_a_step;  // spikes are read out after so many ticks; 0: as the engine likes
  ImageContents (*build)();
};

[[nodiscard]] const std::vector<BenchNetwork>& bench_networks();

}  // namespace tectum::bench
