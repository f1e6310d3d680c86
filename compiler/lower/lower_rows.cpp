#include "compiler/lower/lower_rows.h"

#include <algorithm>
#include <tuple>

namespace tectum {
namespace {

struct Entry {
  std::uint32_t delay_ticks;
  std::uint32_t slot;
  std::int32_t quanta;
};

/// Entries grouped by presynaptic neuron: row i is [begin[i], begin[i + 1]).
struct Rows {
  std::vector<std::size_t> begin;
  std::vector<Entry> entries;
};

Rows gather_rows(const Network& network, const SlotLayout& layout) {
  const Synapses& synapses = network.synapses;
  Rows rows;
  rows.begin.assign(std::size_t{network.neuron_count()} + 1, 0);
  for (const std::uint32_t pre : synapses.pre) {
    ++rows.begin[std::size_t{pre} + 1];
  }
  for (std::size_t i = 1; i < rows.begin.size(); ++i) {
    rows.begin[i] += rows.begin[i - 1];
  }
  std::vector<std::size_t> next(rows.begin.begin(), rows.begin.end() - 1);
  rows.entries.resize(synapses.size());
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    const Pathway& pathway = network.pathways[synapses.pathway[s]];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    const std::size_t local = synapses.post[s] - post.first_neuron;
    const std::uint32_t slot =
        layout.slot_of[pathway.post_population][std::size_t{pathway.receptor} * post.size + local];
    rows.entries[next[synapses.pre[s]]++] = {synapses.delay_ticks[s], slot, synapses.quanta[s]};
  }
  return rows;
}

void append_segment(const Entry* begin, const Entry* end, ImageContents& image) {
  SegmentRecord segment{};
  segment.delay_ticks = begin->delay_ticks;
  segment.target_begin = static_cast<std::uint32_t>(image.targets.size());
  const bool has_one_weight = std::all_of(begin, end, [&](const Entry& e) { return e.quanta == begin->quanta; });
  if (has_one_weight) {
    segment.flags = kSegmentOneWeight;
    const bool can_share = !image.weights.empty() && image.weights.back() == begin->quanta;
    if (!can_share) {
      image.weights.push_back(begin->quanta);
    }
    segment.weight_begin = static_cast<std::uint32_t>(image.weights.size() - 1);
  } else {
    segment.weight_begin = static_cast<std::uint32_t>(image.weights.size());
  }
  for (const Entry* entry = begin; entry != end; ++entry) {
    image.targets.push_back(entry->slot);
    if (!has_one_weight) {
      image.weights.push_back(entry->quanta);
    }
  }
  image.segments.push_back(segment);
  image.max_delay_ticks = std::max(image.max_delay_ticks, segment.delay_ticks);
}

}  // namespace

void lower_rows(const Network& network, const SlotLayout& layout, ImageContents& image) {
  Rows rows = gather_rows(network, layout);
  image.targets.reserve(rows.entries.size());
  const auto before = [](const Entry& a, const Entry& b) {
    return std::tie(a.delay_ticks, a.slot) < std::tie(b.delay_ticks, b.slot);
  };
  for (std::size_t i = 0; i + 1 < rows.begin.size(); ++i) {
    image.row_begin.push_back(static_cast<std::uint32_t>(image.segments.size()));
    Entry* const begin = rows.entries.data() + rows.begin[i];
    Entry* const end = rows.entries.data() + rows.begin[i + 1];
    if (!std::is_sorted(begin, end, before)) {
      std::stable_sort(begin, end, before);
    }
    for (const Entry* from = begin; from != end;) {
      const Entry* to = from;
      while (to != end && to->delay_ticks == from->delay_ticks) {
        ++to;
      }
      append_segment(from, to, image);
      from = to;
    }
  }
  image.row_begin.push_back(static_cast<std::uint32_t>(image.segments.size()));
  SegmentRecord sentinel{};
  sentinel.target_begin = static_cast<std::uint32_t>(image.targets.size());
  sentinel.weight_begin = static_cast<std::uint32_t>(image.weights.size());
  image.segments.push_back(sentinel);
}

}  // namespace tectum
