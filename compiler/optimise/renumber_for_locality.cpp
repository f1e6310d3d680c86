#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "compiler/optimise/passes.h"

namespace tectum {
namespace {

/// How strongly populations belong together: for each, its neighbours with the number of synapses between them.
struct Affinity {
  std::vector<std::vector<std::pair<std::uint32_t, std::uint64_t>>> neighbours;
};

Affinity affinity_of(const Network& network) {
  std::vector<std::uint64_t> synapses_of(network.pathways.size(), 0);
  for (const std::uint32_t pathway : network.synapses.pathway) {
    ++synapses_of[pathway];
  }
  Affinity affinity;
  affinity.neighbours.resize(network.populations.size());
  for (std::size_t p = 0; p < network.pathways.size(); ++p) {
    const Pathway& pathway = network.pathways[p];
    if (synapses_of[p] > 0 && pathway.pre_population != pathway.post_population) {
      affinity.neighbours[pathway.pre_population].emplace_back(pathway.post_population, synapses_of[p]);
      affinity.neighbours[pathway.post_population].emplace_back(pathway.pre_population, synapses_of[p]);
    }
  }
  return affinity;
}

/// Populations one after the other, next always the one with the most synapses from and to those already placed; of
/// equals the first in the circuit.
std::vector<std::uint32_t> grow_order(const Affinity& affinity) {
  const auto count = static_cast<std::uint32_t>(affinity.neighbours.size());
  struct Candidate {
    std::uint64_t pull;
    std::uint32_t population;
    bool operator<(const Candidate& other) const {
      return std::tie(pull, other.population) < std::tie(other.pull, population);
    }
  };
  std::vector<std::uint64_t> pull(count, 0);
  std::vector<bool> is_placed(count, false);
  std::priority_queue<Candidate> candidates;  // entries of an older pull stay behind and are passed over
  for (std::uint32_t p = 0; p < count; ++p) {
    candidates.push({0, p});
  }
  std::vector<std::uint32_t> order;
  while (order.size() < count) {
    const std::uint32_t next = candidates.top().population;
    candidates.pop();
    if (is_placed[next]) {
      continue;
    }
    is_placed[next] = true;
    order.push_back(next);
    for (const auto& [neighbour, synapses] : affinity.neighbours[next]) {
      pull[neighbour] += synapses;
      if (!is_placed[neighbour]) {
        candidates.push({pull[neighbour], neighbour});
      }
    }
  }
  return order;
}

/// Mean over all synapses of how many neurons lie between the beginnings of the two populations.
double mean_distance(const Network& network, const Affinity& affinity, const std::vector<std::uint32_t>& rank) {
  std::vector<std::uint32_t> order(rank.size());
  for (std::uint32_t p = 0; p < rank.size(); ++p) {
    order[rank[p]] = p;
  }
  std::vector<std::uint64_t> place(rank.size(), 0);
  std::uint64_t next = 0;
  for (const std::uint32_t p : order) {
    place[p] = next;
    next += network.populations[p].size;
  }
  double sum = 0;
  double count = 0;
  for (std::size_t p = 0; p < place.size(); ++p) {
    for (const auto& [neighbour, synapses] : affinity.neighbours[p]) {
      const std::uint64_t apart = std::max(place[p], place[neighbour]) - std::min(place[p], place[neighbour]);
      sum += static_cast<double>(synapses) * static_cast<double>(apart);
      count += static_cast<double>(synapses);
    }
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace

std::string renumber_for_locality(Network& network) {
  const Affinity affinity = affinity_of(network);
  std::vector<std::uint32_t> as_written(network.populations.size());
  std::iota(as_written.begin(), as_written.end(), 0U);
  std::vector<std::uint32_t> rank(network.populations.size());
  std::uint32_t next = 0;
  for (const std::uint32_t p : grow_order(affinity)) {
    rank[p] = next++;
  }
  const double before = mean_distance(network, affinity, as_written);
  const double after = mean_distance(network, affinity, rank);
  if (after >= before) {
    return "the written order is as good";
  }
  network.layout_rank = std::move(rank);
  return fmt::format("joined populations lie {:.0f} neurons apart in the mean, before {:.0f}", after, before);
}

}  // namespace tectum
