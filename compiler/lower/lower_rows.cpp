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

/// The same where something learns: whose entry it is, and whether it learns.
struct TracedEntry : Entry {
  std::uint32_t synapse;
  bool learns;
};

void trace(const Network&, std::size_t, Entry&) {}
void trace(const Network& network, std::size_t synapse, TracedEntry& entry) {
  entry.synapse = static_cast<std::uint32_t>(synapse);
  entry.learns = network.pathways[network.synapses.pathway[synapse]].rule != kNoRule;
}
constexpr bool learns(const Entry&) { return false; }
bool learns(const TracedEntry& entry) { return entry.learns; }
void note_target(const Entry&, std::uint32_t, std::vector<std::uint32_t>&) {}
void note_target(const TracedEntry& entry, std::uint32_t target, std::vector<std::uint32_t>& target_of) {
  target_of[entry.synapse] = target;
}

/// Entries grouped by presynaptic neuron: row i is [begin[i], begin[i + 1]).
template <typename Kind>
struct Rows {
  std::vector<std::size_t> begin;
  std::vector<Kind> entries;
};

template <typename Kind>
Rows<Kind> gather_rows(const Network& network, const SlotLayout& layout) {
  const Synapses& synapses = network.synapses;
  Rows<Kind> rows;
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
    Kind& entry = rows.entries[next[synapses.pre[s]]++];
    entry.delay_ticks = synapses.delay_ticks[s];
    entry.slot = slot;
    entry.quanta = synapses.quanta[s];
    trace(network, s, entry);
  }
  return rows;
}

/// Fills segments, targets and weights row by row.
template <typename Kind>
class RowLowering {
 public:
  RowLowering(const Network& network, ImageContents& image, std::vector<std::uint32_t>& target_of)
      : may_share_(network.shares_constant_weights), image_(image), target_of_(target_of) {}

  void run(Rows<Kind>& rows) {
    image_.targets.reserve(rows.entries.size());
    const auto before = [](const Entry& a, const Entry& b) {
      return std::tie(a.delay_ticks, a.slot) < std::tie(b.delay_ticks, b.slot);
    };
    for (std::size_t i = 0; i + 1 < rows.begin.size(); ++i) {
      image_.row_begin.push_back(static_cast<std::uint32_t>(image_.segments.size()));
      Kind* const begin = rows.entries.data() + rows.begin[i];
      Kind* const end = rows.entries.data() + rows.begin[i + 1];
      if (!std::is_sorted(begin, end, before)) {
        std::stable_sort(begin, end, before);
      }
      for (const Kind* from = begin; from != end;) {
        const Kind* to = from;
        while (to != end && to->delay_ticks == from->delay_ticks) {
          ++to;
        }
        append_segment(from, to);
        from = to;
      }
    }
    image_.row_begin.push_back(static_cast<std::uint32_t>(image_.segments.size()));
    SegmentRecord sentinel{};
    sentinel.target_begin = static_cast<std::uint32_t>(image_.targets.size());
    sentinel.weight_begin = static_cast<std::uint32_t>(image_.weights.size());
    image_.segments.push_back(sentinel);
  }

 private:
  void append_segment(const Kind* begin, const Kind* end) {
    SegmentRecord segment{};
    segment.delay_ticks = begin->delay_ticks;
    segment.target_begin = static_cast<std::uint32_t>(image_.targets.size());
    const bool may_learn = std::any_of(begin, end, [](const Kind& e) { return learns(e); });
    const bool has_one_weight =
        may_share_ && !may_learn && std::all_of(begin, end, [&](const Entry& e) { return e.quanta == begin->quanta; });
    if (has_one_weight) {
      segment.flags = kSegmentOneWeight;
      const bool can_share = !image_.weights.empty() && image_.weights.back() == begin->quanta && !last_may_learn_;
      if (!can_share) {
        image_.weights.push_back(begin->quanta);
      }
      segment.weight_begin = static_cast<std::uint32_t>(image_.weights.size() - 1);
    } else {
      segment.weight_begin = static_cast<std::uint32_t>(image_.weights.size());
    }
    for (const Kind* entry = begin; entry != end; ++entry) {
      note_target(*entry, static_cast<std::uint32_t>(image_.targets.size()), target_of_);
      image_.targets.push_back(entry->slot);
      if (!has_one_weight) {
        image_.weights.push_back(entry->quanta);
      }
    }
    last_may_learn_ = may_learn;
    image_.segments.push_back(segment);
    image_.max_delay_ticks = std::max(image_.max_delay_ticks, segment.delay_ticks);
  }

  bool may_share_;  // one weight for a run of equal ones
  ImageContents& image_;
  std::vector<std::uint32_t>& target_of_;
  bool last_may_learn_ = false;  // the segment before this one
};

}  // namespace

std::vector<std::uint32_t> lower_rows(const Network& network, const SlotLayout& layout, ImageContents& image) {
  std::vector<std::uint32_t> target_of;
  if (network.rules.empty()) {
    Rows<Entry> rows = gather_rows<Entry>(network, layout);
    RowLowering<Entry>(network, image, target_of).run(rows);
  } else {
    target_of.resize(network.synapses.size());
    Rows<TracedEntry> rows = gather_rows<TracedEntry>(network, layout);
    RowLowering<TracedEntry>(network, image, target_of).run(rows);
  }
  return target_of;
}

}  // namespace tectum
