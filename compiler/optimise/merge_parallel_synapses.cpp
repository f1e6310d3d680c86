#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>

#include "compiler/optimise/keep_synapses.h"
#include "compiler/optimise/passes.h"

namespace tectum {
namespace {

/// Pathways that join the same two population sides onto the same receptor as another one: their synapses can be
/// parallel.
void mark_shared(const Network& network, std::vector<bool>& may_be_parallel) {
  const auto ends = [&](std::size_t p) {
    const Pathway& pathway = network.pathways[p];
    return std::tuple(pathway.pre_population, pathway.post_population, pathway.receptor);
  };
  std::vector<std::uint32_t> order(network.pathways.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return ends(a) < ends(b); });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (ends(order[i - 1]) == ends(order[i])) {
      may_be_parallel[order[i - 1]] = true;
      may_be_parallel[order[i]] = true;
    }
  }
}

/// Pathways that may join two neurons twice, as an edge list can: rules list every pair once, by source or by target.
void mark_repeating(const Synapses& synapses, std::vector<bool>& may_be_parallel) {
  for (std::size_t begin = 0; begin < synapses.size();) {
    const std::uint32_t pathway = synapses.pathway[begin];
    bool is_by_source = true;
    bool is_by_target = true;
    std::size_t s = begin + 1;
    for (; s < synapses.size() && synapses.pathway[s] == pathway; ++s) {
      const auto pair = [&](std::size_t i) { return std::tie(synapses.pre[i], synapses.post[i]); };
      const auto turned = [&](std::size_t i) { return std::tie(synapses.post[i], synapses.pre[i]); };
      is_by_source = is_by_source && pair(s - 1) < pair(s);
      is_by_target = is_by_target && turned(s - 1) < turned(s);
    }
    if (!is_by_source && !is_by_target) {
      may_be_parallel[pathway] = true;
    }
    begin = s;
  }
}

/// The synapses of the marked pathways by their source; of one source in the network's order.
struct SourceRows {
  std::vector<std::size_t> begin;  // row i is [begin[i], begin[i + 1])
  std::vector<std::uint32_t> synapses;
};

SourceRows rows_of(const Network& network, const std::vector<bool>& is_marked) {
  const Synapses& synapses = network.synapses;
  SourceRows rows;
  rows.begin.assign(std::size_t{network.neuron_count()} + 1, 0);
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    rows.begin[std::size_t{synapses.pre[s]} + 1] += is_marked[synapses.pathway[s]] ? 1 : 0;
  }
  std::partial_sum(rows.begin.begin(), rows.begin.end(), rows.begin.begin());
  rows.synapses.resize(rows.begin.back());
  std::vector<std::size_t> next(rows.begin.begin(), rows.begin.end() - 1);
  for (std::uint32_t s = 0; s < synapses.size(); ++s) {
    if (is_marked[synapses.pathway[s]]) {
      rows.synapses[next[synapses.pre[s]]++] = s;
    }
  }
  return rows;
}

struct Arrival {
  std::uint32_t post, receptor, delay_ticks, synapse;

  [[nodiscard]] auto place() const { return std::tie(post, receptor, delay_ticks); }
};

}  // namespace

std::string merge_parallel_synapses(Network& network) {
  Synapses& synapses = network.synapses;
  std::vector<bool> may_be_parallel(network.pathways.size(), false);
  mark_shared(network, may_be_parallel);
  mark_repeating(synapses, may_be_parallel);
  for (std::size_t p = 0; p < network.pathways.size(); ++p) {
    // What learns goes its own way.
    may_be_parallel[p] = may_be_parallel[p] && network.pathways[p].rule == kNoRule;
  }
  const SourceRows rows = rows_of(network, may_be_parallel);
  std::vector<bool> keep(synapses.size(), true);
  std::vector<Arrival> row;
  bool has_merged = false;
  for (std::size_t r = 0; r + 1 < rows.begin.size(); ++r) {
    row.clear();
    for (std::size_t i = rows.begin[r]; i < rows.begin[r + 1]; ++i) {
      const std::uint32_t s = rows.synapses[i];
      row.push_back({synapses.post[s], network.pathways[synapses.pathway[s]].receptor, synapses.delay_ticks[s], s});
    }
    std::sort(row.begin(), row.end(), [](const Arrival& a, const Arrival& b) {
      return std::tuple_cat(a.place(), std::tie(a.synapse)) < std::tuple_cat(b.place(), std::tie(b.synapse));
    });
    std::size_t first = 0;
    for (std::size_t i = 1; i < row.size(); ++i) {
      if (row[i].place() == row[first].place()) {
        synapses.quanta[row[first].synapse] += synapses.quanta[row[i].synapse];
        keep[row[i].synapse] = false;
        has_merged = true;
      } else {
        first = i;
      }
    }
  }
  if (has_merged) {
    keep_synapses(keep, synapses);
  }
  return "";
}

}  // namespace tectum
