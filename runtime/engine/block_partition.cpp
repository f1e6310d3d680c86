#include "runtime/engine/block_partition.h"

#include <algorithm>

namespace tectum {
namespace {

std::size_t words_for(std::size_t neurons) { return (neurons + kWordBits - 1) / kWordBits; }

}  // namespace

BlockPartition::BlockPartition(const BlockNetwork& network, std::vector<GroupPart> parts, bool is_one_of_several)
    : network_(network),
      wheel_(network.image.header.max_delay_ticks, rows_in_flight(network.image)),
      part_of_(network.groups.size(), kNone),
      runs_(std::make_unique_for_overwrite<WaitingRun[]>(kRunCapacity)) {
  std::size_t marked_words = 0;
  std::size_t marked_neurons = 0;
  std::uint32_t largest = 0;
  for (const GroupPart& part : parts) {
    const std::uint32_t size = part.end - part.begin;
    neuron_count_ += size;
    receptor_count_ += network.image.groups[part.group].receptor_count;
    largest = std::max(largest, size);
    if (network.groups[part.group]->wants_marks()) {
      marked_words += words_for(size);
      marked_neurons += size + 1;  // a neuron that is listed already is written behind the end
    }
  }
  marks_.resize(marked_words);
  lists_ = std::make_unique_for_overwrite<std::uint32_t[]>(marked_neurons);
  fired_.resize(largest);
  spikes_ = std::make_unique_for_overwrite<std::uint32_t[]>(neuron_count_ * kMaxSliceTicks);

  std::uint64_t* marks = marks_.data();
  std::uint32_t* list = lists_.get();
  for (const GroupPart& part : parts) {
    const UpdateGroup& group = *network.groups[part.group];
    part_of_[part.group] = static_cast<std::uint32_t>(parts_.size());
    // Marks are counted from the group's first neuron: this part's words start at its own.
    parts_.push_back(
        {part,
         group.is_divisible() && !group.wants_marks(),
         TouchedNeurons(group.wants_marks() ? marks - part.begin / kWordBits : nullptr, list, hot_arrays_of(group)),
         0,
         {},
         {}});
    if (group.wants_marks()) {
      marks += words_for(part.end - part.begin);
      list += part.end - part.begin + 1;
    }
  }
  if (is_one_of_several) {
    list_own_runs();
  }
  reset();
}

void BlockPartition::reset() noexcept {
  wheel_.clear();
  for (Part& part : parts_) {
    part.touched.clear();
    part.idle_until = 0;
    part.first_run.fill(kNone);
    part.has_input.fill(false);
  }
  run_count_ = 0;
  spike_count_ = {};
  event_count_ = 0;
}

void BlockPartition::rouse(std::uint32_t group) noexcept {
  if (part_of_[group] != kNone) {
    parts_[part_of_[group]].idle_until = 0;
  }
}

void BlockPartition::prefetch(const SegmentRecord& segment, std::uint32_t begin, std::uint32_t end) const noexcept {
  constexpr std::uint32_t kLineElements = 16;
  constexpr std::uint32_t kLongest = 256;  // elements; the processor follows longer rows by itself
  const bool has_one_weight = (segment.flags & kSegmentOneWeight) != 0;
  for (std::uint32_t at = begin; at < std::min(end, begin + kLongest); at += kLineElements) {
    __builtin_prefetch(network_.image.targets.data() + at);
    __builtin_prefetch(network_.image.weights.data() + segment.weight_begin +
                       (has_one_weight ? 0 : at - segment.target_begin));
  }
}

// First where the row is found, then, when that has come, the row itself.
void BlockPartition::prefetch_place(std::uint32_t index) const noexcept {
  __builtin_prefetch(network_.image.segments.data() + index);
  if (!own_run_begin_.empty()) {
    __builtin_prefetch(own_run_begin_.data() + index);
  }
}

void BlockPartition::prefetch(std::uint32_t index) const noexcept {
  const SegmentRecord& segment = network_.image.segments[index];
  if (own_run_begin_.empty()) {
    prefetch(segment, segment.target_begin, network_.image.segments[index + 1].target_begin);
    return;
  }
  for (std::uint32_t r = own_run_begin_[index]; r < own_run_begin_[index + 1]; ++r) {
    prefetch(segment, own_runs_[r].begin, own_runs_[r].end);
  }
}

// Cuts a segment into runs of one receptor of one of this partition's parts: take_run(part, first slot, begin, end).
template <typename TakeRun>
void BlockPartition::search_row(std::uint32_t index, TakeRun take_run) const noexcept {
  const std::uint32_t* const all = network_.image.targets.data();
  const std::uint32_t* const end = all + network_.image.segments[index + 1].target_begin;
  for (const std::uint32_t* at = all + network_.image.segments[index].target_begin; at != end;) {
    const SlotRange& range = network_.ranges.of(*at);
    const std::uint32_t* const after = end[-1] < range.end ? end : std::lower_bound(at, end, range.end);
    const std::uint32_t p = part_of_[range.group];
    if (p != kNone) {
      const GroupPart& part = parts_[p].range;
      const std::uint32_t* const first = part.begin == 0 ? at : std::lower_bound(at, after, range.begin + part.begin);
      const std::uint32_t* const last =
          range.begin + part.end >= range.end ? after : std::lower_bound(first, after, range.begin + part.end);
      if (first != last) {
        take_run(p, range.begin, static_cast<std::uint32_t>(first - all), static_cast<std::uint32_t>(last - all));
      }
    }
    at = after;
  }
}

void BlockPartition::list_own_runs() {
  const auto segments = static_cast<std::uint32_t>(network_.image.segments.size() - 1);
  for (std::uint32_t index = 0; index < segments; ++index) {
    own_run_begin_.push_back(static_cast<std::uint32_t>(own_runs_.size()));
    search_row(index, [this](std::uint32_t part, std::uint32_t first_slot, std::uint32_t begin, std::uint32_t end) {
      own_runs_.push_back({begin, end, part, first_slot});
    });
  }
  own_run_begin_.push_back(static_cast<std::uint32_t>(own_runs_.size()));
  own_runs_.shrink_to_fit();
}

SynapseRun BlockPartition::run_of(const SegmentRecord& segment, std::uint32_t begin, std::uint32_t end) const noexcept {
  const std::uint32_t* const targets = network_.image.targets.data();
  const std::int32_t* const weights = network_.image.weights.data() + segment.weight_begin;
  const bool has_one_weight = (segment.flags & kSegmentOneWeight) != 0;
  return {targets + begin, targets + end, has_one_weight ? weights : weights + (begin - segment.target_begin),
          has_one_weight};
}

// take_run(part, first slot, run) for each run of a segment onto this partition.
template <typename TakeRun>
void BlockPartition::split_row(std::uint32_t index, TakeRun take_run) noexcept {
  const SegmentRecord& segment = network_.image.segments[index];
  const auto take = [&](std::uint32_t part, std::uint32_t first_slot, std::uint32_t begin, std::uint32_t end) {
    event_count_ += end - begin;
    take_run(parts_[part], first_slot, run_of(segment, begin, end));
  };
  if (own_run_begin_.empty()) {
    search_row(index, take);
    return;
  }
  for (std::uint32_t r = own_run_begin_[index]; r < own_run_begin_[index + 1]; ++r) {
    take(own_runs_[r].part, own_runs_[r].first_slot, own_runs_[r].begin, own_runs_[r].end);
  }
}

// What is due at a tick. A row that has another delay waits on for it.
template <typename TakeRun>
void BlockPartition::take_due_rows(std::uint64_t tick, TakeRun take_run) noexcept {
  constexpr std::uint32_t kRowsAhead = 3;
  constexpr std::uint32_t kPlacesAhead = 8;
  std::uint32_t index = wheel_.take(tick);
  while (index != EventWheel::kNone) {
    const EventWheel::Chunk& chunk = wheel_.chunk(index);
    for (std::uint32_t r = 0; r < chunk.count; ++r) {
      if (r + kPlacesAhead < chunk.count) {
        prefetch_place(chunk.rows[r + kPlacesAhead].segment);
      }
      if (r + kRowsAhead < chunk.count) {
        prefetch(chunk.rows[r + kRowsAhead].segment);
      }
      const DueRow row = chunk.rows[r];
      split_row(row.segment, take_run);
      if (row.segment + 1 < row.row_end) {
        const std::uint32_t longer = network_.image.segments[row.segment + 1].delay_ticks;
        wheel_.push(tick + longer - network_.image.segments[row.segment].delay_ticks, {row.segment + 1, row.row_end});
      }
    }
    const std::uint32_t next_chunk = chunk.next;
    wheel_.release(index);
    index = next_chunk;
  }
}

// Lists the runs that are due in ticks [first, count) and returns before which tick it had to stop.
std::uint32_t BlockPartition::collect(std::uint64_t tick, std::uint32_t first, std::uint32_t count) noexcept {
  run_count_ = 0;
  for (std::uint32_t k = first; k < count; ++k) {
    if (wheel_.row_count(tick + k) * receptor_count_ > kRunCapacity - run_count_) {
      return k;
    }
    take_due_rows(tick + k, [this, k](Part& part, std::uint32_t first_slot, const SynapseRun& run) {
      runs_[run_count_] = {run, first_slot, part.first_run[k]};
      part.first_run[k] = run_count_++;
      part.has_input[k] = true;
    });
  }
  return count;
}

void BlockPartition::deliver(Part& part, std::uint32_t k, std::uint32_t first_slot, const SynapseRun& run) noexcept {
  part.has_input[k] = true;
  if (network_.groups[part.range.group]->wants_marks()) {
    part.touched.add_run(network_.inputs, first_slot, run);
  } else {
    add_run(network_.inputs, run);
  }
}

// Delivers the waiting runs of tick k as far as neuron `block_end`; they go on from there.
void BlockPartition::deliver_block(const Part& part, std::uint32_t k, std::uint32_t block_end) noexcept {
  std::int32_t* const inputs = network_.inputs;
  for (std::uint32_t r = part.first_run[k]; r != kNone; r = runs_[r].next) {
    SynapseRun& run = runs_[r].run;
    const std::uint32_t limit = runs_[r].first_slot + block_end;
    const std::ptrdiff_t step = run.has_one_weight ? 0 : 1;
    const std::uint32_t* target = run.target;
    const std::int32_t* weight = run.weight;
    for (; target != run.end && *target < limit; ++target, weight += step) {
      inputs[*target] = add_quanta(inputs[*target], *weight);
    }
    run.target = target;
    run.weight = weight;
  }
}

void BlockPartition::advance(Part& part, const SliceOfTicks& slice, std::uint32_t k, std::uint32_t begin,
                             std::uint32_t end) noexcept {
  const GroupRecord& record = network_.image.groups[part.range.group];
  GroupTick now{.tick = slice.tick + k,
                .begin = begin,
                .end = end,
                .inputs = network_.inputs + record.first_slot,
                .touched = part.touched.list(),
                .touched_count = part.touched.count(),
                .fired = fired_.data()};
  network_.groups[part.range.group]->advance(now);
  if (slice.injected.any && k == 0) {
    add_injected(slice.injected, record.first_neuron, now);
  }
  std::uint32_t* const out = spikes_.get() + std::size_t{k} * neuron_count_;
  for (std::uint32_t f = 0; f < now.fired_count; ++f) {
    out[spike_count_[k]++] = record.first_neuron + fired_[f];
  }
  part.idle_until = now.idle_until;
}

void BlockPartition::run_part(Part& part, const SliceOfTicks& slice, std::uint32_t first, std::uint32_t end) noexcept {
  const std::uint32_t last_neuron = part.range.end;
  const std::uint32_t block = part.is_swept_in_blocks ? kBlockNeurons : last_neuron - part.range.begin;
  for (std::uint32_t begin = part.range.begin; begin < last_neuron; begin += block) {
    const std::uint32_t block_end = std::min(begin + block, last_neuron);
    for (std::uint32_t k = first; k < end; ++k) {
      const bool is_idle = slice.tick + k < part.idle_until && !part.has_input[k] && !(slice.injected.any && k == 0);
      if (is_idle) {
        continue;
      }
      if (!part.is_swept_in_blocks) {
        for (std::uint32_t r = part.first_run[k]; r != kNone; r = runs_[r].next) {
          deliver(part, k, runs_[r].first_slot, runs_[r].run);
        }
      } else {
        deliver_block(part, k, block_end);
      }
      advance(part, slice, k, begin, block_end);
      part.touched.clear();
    }
  }
  for (std::uint32_t k = first; k < end; ++k) {
    part.first_run[k] = kNone;
    part.has_input[k] = false;
  }
}

void BlockPartition::run(const SliceOfTicks& slice) noexcept {
  std::fill_n(spike_count_.begin(), slice.count, 0U);
  for (std::uint32_t first = 0; first < slice.count;) {
    std::uint32_t end = collect(slice.tick, first, slice.count);
    if (end == first) {
      // More runs than can wait: this one tick's are delivered at once, to all blocks.
      take_due_rows(slice.tick + first, [this, first](Part& part, std::uint32_t first_slot, const SynapseRun& run) {
        deliver(part, first, first_slot, run);
      });
      end = first + 1;
    }
    for (Part& part : parts_) {
      run_part(part, slice, first, end);
    }
    first = end;
  }
}

void BlockPartition::receive(const SliceOfTicks& slice, const BlockPartition& from) noexcept {
  const SpikeImage& image = network_.image;
  for (std::uint32_t k = 0; k < slice.count; ++k) {
    for (const std::uint32_t neuron : from.spikes(k)) {
      const std::uint32_t segment = image.row_begin[neuron];
      const std::uint32_t end = image.row_begin[neuron + 1];
      if (segment < end) {
        wheel_.push(slice.tick + k + image.segments[segment].delay_ticks, {segment, end});
      }
    }
  }
}

void BlockPartition::add_input(std::uint32_t slot, std::int32_t quanta) noexcept {
  const SlotRange& range = network_.ranges.of(slot);
  const std::uint32_t p = part_of_[range.group];
  const std::uint32_t neuron = slot - range.begin;
  if (p != kNone && neuron >= parts_[p].range.begin && neuron < parts_[p].range.end) {
    deliver(parts_[p], 0, range.begin, SynapseRun{&slot, &slot + 1, &quanta, true});
  }
}

}  // namespace tectum
