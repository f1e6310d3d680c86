#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>

#include "compiler/optimise/keep_synapses.h"
#include "compiler/optimise/passes.h"

namespace tectum {
namespace {

/// Pairs of population sides that more than one pathway joins onto the same receptor: only there can synapses be
/// parallel, apart from a pathway that repeats itself, which no rule does. What learns goes its own way.
std::vector<bool> may_be_parallel(const Network& network) {
  const auto ends = [&](std::size_t p) {
    const Pathway& pathway = network.pathways[p];
    return std::tuple(pathway.pre_population, pathway.post_population, pathway.receptor);
  };
  std::vector<std::uint32_t> order(network.pathways.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return ends(a) < ends(b); });
  std::vector<bool> result(network.pathways.size(), false);
  order.erase(
      std::remove_if(order.begin(), order.end(), [&](std::uint32_t p) { return network.pathways[p].rule != kNoRule; }),
      order.end());
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (ends(order[i - 1]) == ends(order[i])) {
      result[order[i - 1]] = true;
      result[order[i]] = true;
    }
  }
  return result;
}

}  // namespace

void merge_parallel_synapses(Network& network) {
  const std::vector<bool> is_candidate = may_be_parallel(network);
  Synapses& synapses = network.synapses;
  std::vector<std::uint32_t> order;
  for (std::uint32_t s = 0; s < synapses.size(); ++s) {
    if (is_candidate[synapses.pathway[s]]) {
      order.push_back(s);
    }
  }
  const auto key = [&](std::uint32_t s) {
    return std::tuple(synapses.pre[s], synapses.post[s], network.pathways[synapses.pathway[s]].receptor,
                      synapses.delay_ticks[s]);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<bool> keep(synapses.size(), true);
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i + 1;
    while (j < order.size() && key(order[j]) == key(order[i])) {
      synapses.quanta[order[i]] += synapses.quanta[order[j]];
      keep[order[j]] = false;
      ++j;
    }
    i = j;
  }
  keep_synapses(keep, synapses);
}

}  // namespace tectum
