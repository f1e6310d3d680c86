#include "compiler/elaborate/same_tick_order.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

namespace tectum {
namespace {

/// Pathways with a same-tick synapse, by presynaptic population.
std::vector<std::vector<std::uint32_t>> same_tick_edges(const Network& network) {
  std::vector<bool> has_same_tick(network.pathways.size(), false);
  for (std::size_t s = 0; s < network.synapses.size(); ++s) {
    if (network.synapses.delay_ticks[s] == 0) {
      has_same_tick[network.synapses.pathway[s]] = true;
    }
  }
  std::vector<std::vector<std::uint32_t>> edges(network.populations.size());
  for (std::uint32_t p = 0; p < network.pathways.size(); ++p) {
    if (has_same_tick[p]) {
      edges[network.pathways[p].pre_population].push_back(p);
    }
  }
  return edges;
}

/// Walks among the populations that no order reaches, always to one that has a way on, until one repeats.
std::vector<std::uint32_t> find_cycle(const Network& network, const std::vector<std::vector<std::uint32_t>>& edges,
                                      const std::vector<std::uint32_t>& open_inputs) {
  // Walking backwards always finds a predecessor that is itself unreachable by an order.
  std::vector<std::uint32_t> incoming(network.populations.size(), 0);
  for (const std::vector<std::uint32_t>& list : edges) {
    for (const std::uint32_t p : list) {
      if (open_inputs[network.pathways[p].pre_population] > 0) {
        incoming[network.pathways[p].post_population] = p;
      }
    }
  }
  const auto first = static_cast<std::uint32_t>(
      std::find_if(open_inputs.begin(), open_inputs.end(), [](std::uint32_t n) { return n > 0; }) -
      open_inputs.begin());
  std::vector<std::uint32_t> path;
  std::vector<bool> is_seen(network.populations.size(), false);
  std::uint32_t at = first;
  while (!is_seen[at]) {
    is_seen[at] = true;
    path.push_back(incoming[at]);
    at = network.pathways[incoming[at]].pre_population;
  }
  // `at` is on the cycle: drop the steps walked before it, and turn the rest to run forwards.
  std::vector<std::uint32_t> cycle;
  std::uint32_t step = at;
  do {
    cycle.push_back(incoming[step]);
    step = network.pathways[incoming[step]].pre_population;
  } while (step != at);
  std::reverse(cycle.begin(), cycle.end());
  const auto earliest = std::min_element(cycle.begin(), cycle.end());
  std::rotate(cycle.begin(), earliest, cycle.end());
  return cycle;
}

}  // namespace

SameTickOrder same_tick_order(const Network& network) {
  const auto edges = same_tick_edges(network);
  std::vector<std::uint32_t> open_inputs(network.populations.size(), 0);
  for (const std::vector<std::uint32_t>& list : edges) {
    for (const std::uint32_t p : list) {
      ++open_inputs[network.pathways[p].post_population];
    }
  }
  using Ranked = std::pair<std::uint32_t, std::uint32_t>;  // layout rank, population
  std::priority_queue<Ranked, std::vector<Ranked>, std::greater<>> free;
  const auto set_free = [&](std::uint32_t i) {
    free.emplace(network.layout_rank.empty() ? i : network.layout_rank[i], i);
  };
  for (std::uint32_t i = 0; i < open_inputs.size(); ++i) {
    if (open_inputs[i] == 0) {
      set_free(i);
    }
  }
  SameTickOrder order;
  while (!free.empty()) {
    const std::uint32_t i = free.top().second;
    free.pop();
    order.populations.push_back(i);
    for (const std::uint32_t p : edges[i]) {
      if (--open_inputs[network.pathways[p].post_population] == 0) {
        set_free(network.pathways[p].post_population);
      }
    }
  }
  if (order.populations.size() != network.populations.size()) {
    order.cycle = find_cycle(network, edges, open_inputs);
    order.populations.clear();
  }
  return order;
}

}  // namespace tectum
