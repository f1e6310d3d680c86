#include "compiler/optimise/optimise.h"

#include <array>
#include <chrono>

#include "compiler/optimise/passes.h"

namespace tectum {
namespace {

constexpr std::array kPasses = {
    PassInfo{"drop_mute_synapses", "take out the synapses of neurons that can never fire, but for those that learn",
             OptimisationLevel::O2, drop_mute_synapses},
    PassInfo{"merge_parallel_synapses", "join synapses of the same neurons, receptor and delay", OptimisationLevel::O1,
             merge_parallel_synapses},
    PassInfo{"drop_empty_synapses", "take out synapses whose weight rounds to nothing", OptimisationLevel::O1,
             drop_empty_synapses},
    PassInfo{"share_constant_weights", "store one weight for synapses of one neuron and delay that are equally strong",
             OptimisationLevel::O1, share_constant_weights},
    PassInfo{"renumber_for_locality", "lay populations that are joined next to each other in the engine's memory",
             OptimisationLevel::O2, renumber_for_locality},
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
    done.note = pass.run(network);
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
