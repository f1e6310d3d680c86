#include "compiler/optimise/optimise.h"

#include <array>
#include <chrono>

#include "compiler/optimise/passes.h"

namespace tectum {
namespace {

constexpr std::array kPasses = {
    PassInfo{"merge_parallel_synapses", "join synapses of the same neurons, receptor and delay", OptimisationLevel::O1,
             merge_parallel_synapses},
    PassInfo{"drop_empty_synapses", "take out synapses whose weight rounds to nothing", OptimisationLevel::O1,
             drop_empty_synapses},
};

}  // namespace

std::span<const PassInfo> all_passes() { return kPasses; }

std::vector<PassStats> optimise(Network& network, OptimisationLevel level, std::string_view stop_after) {
  std::vector<PassStats> stats;
  for (const PassInfo& pass : kPasses) {
    if (level < pass.from) {
      continue;
    }
    PassStats done;
    done.name = pass.name;
    done.synapses_before = network.synapses.size();
    const auto begin = std::chrono::steady_clock::now();
    pass.run(network);
    done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    done.synapses_after = network.synapses.size();
    stats.push_back(std::move(done));
    if (pass.name == stop_after) {
      break;
    }
  }
  return stats;
}

}  // namespace tectum
