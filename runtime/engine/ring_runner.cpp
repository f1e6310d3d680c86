#include "runtime/engine/ring_runner.h"

#include <algorithm>
#include <bit>

namespace tectum {
namespace {

constexpr std::size_t kRingBytes = std::size_t{1} << 18U;

}  // namespace

std::uint32_t RingRunner::fitting_ticks(const SpikeImage& image) {
  const std::size_t fitting = kRingBytes / (sizeof(std::int32_t) * std::max(image.header.slot_count, 1U));
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(fitting, 1, kMaxSliceTicks));
}

RingRunner::RingRunner(const SpikeImage& image, const UpdateGroups& groups)
    : image_(image),
      groups_(groups),
      slice_(std::min(shortest_delay_ticks(image), fitting_ticks(image))),
      wheel_(image.header.max_delay_ticks, rows_in_flight(image)),
      ring_(image, groups, slice_),
      busy_((groups.size() + kWordBits - 1) / kWordBits),
      all_groups_(busy_.size()),
      idle_until_(groups.size()),
      fired_(image.header.neuron_count),
      spikes_(std::make_unique_for_overwrite<NeuronId[]>(std::size_t{image.header.neuron_count} * slice_)) {
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const GroupRecord& group = image.groups[g];
    all_groups_[g / kWordBits] |= std::uint64_t{1} << (g % kWordBits);
    is_swept_in_blocks_.push_back(group.size > kBlockNeurons && groups[g]->is_divisible() && !groups[g]->wants_marks());
    is_in_neuron_order_ = is_in_neuron_order_ && (g == 0 || group.first_neuron > image.groups[g - 1].first_neuron);
  }
  RingRunner::reset();
}

void RingRunner::reset() noexcept {
  wheel_.clear();
  ring_.clear();
  busy_ = all_groups_;
  std::fill(idle_until_.begin(), idle_until_.end(), std::uint64_t{0});
  spike_count_ = {};
  event_count_ = 0;
}

void RingRunner::rouse(std::uint32_t group) noexcept {
  busy_[group / kWordBits] |= std::uint64_t{1} << (group % kWordBits);
  idle_until_[group] = 0;
}

// Delivers what is due in tick k of the slice. A row that has another delay waits on for it, perhaps
// for a later tick of this very slice.
void RingRunner::deliver_due_rows(std::uint32_t k) noexcept {
  constexpr std::uint32_t kAhead = 2;
  std::uint32_t index = wheel_.take(tick_ + k);
  while (index != EventWheel::kNone) {
    const EventWheel::Chunk& chunk = wheel_.chunk(index);
    for (std::uint32_t r = 0; r < chunk.count; ++r) {
      if (r + kAhead < chunk.count) {
        ring_.prefetch(chunk.rows[r + kAhead].segment);
      }
      const DueRow row = chunk.rows[r];
      const SegmentRecord& segment = image_.segments[row.segment];
      const SegmentRecord& next = image_.segments[row.segment + 1];
      ring_.deliver(k, row.segment);
      event_count_ += next.target_begin - segment.target_begin;
      if (row.segment + 1 < row.row_end) {
        wheel_.push(tick_ + k + next.delay_ticks - segment.delay_ticks, {row.segment + 1, row.row_end});
      }
    }
    const std::uint32_t next_chunk = chunk.next;
    wheel_.release(index);
    index = next_chunk;
  }
}

void RingRunner::send(std::uint32_t k, std::uint32_t neuron) noexcept {
  spikes_[std::size_t{k} * image_.header.neuron_count + spike_count_[k]++] = NeuronId{neuron};
  std::uint32_t segment = image_.row_begin[neuron];
  const std::uint32_t end = image_.row_begin[neuron + 1];
  if (segment < end && image_.segments[segment].delay_ticks == 0) {
    ring_.deliver(k, segment);
    event_count_ += image_.segments[segment + 1].target_begin - image_.segments[segment].target_begin;
    ++segment;
  }
  if (segment < end) {
    wheel_.push(tick_ + k + image_.segments[segment].delay_ticks, {segment, end});
  }
}

void RingRunner::advance_part(std::uint32_t g, std::uint32_t begin, std::uint32_t end, std::uint32_t k) noexcept {
  const GroupRecord& record = image_.groups[g];
  TouchedNeurons* const touched = ring_.touched(k, g);
  GroupTick now{.tick = tick_ + k,
                .begin = begin,
                .end = end,
                .inputs = ring_.inputs(k, record.first_slot),
                .touched = touched == nullptr ? nullptr : touched->list(),
                .touched_count = touched == nullptr ? 0 : touched->count(),
                .fired = fired_.data()};
  groups_[g]->advance(now);
  if (touched != nullptr) {
    touched->clear();
  }
  if (injected_.any && k == 0) {
    add_injected(injected_, record.first_neuron, now);
  }
  for (std::uint32_t f = 0; f < now.fired_count; ++f) {
    send(k, record.first_neuron + fired_[f]);
  }
  idle_until_[g] = now.idle_until;
}

void RingRunner::advance_group(std::uint32_t g, std::uint32_t ticks) noexcept {
  const std::uint32_t size = image_.groups[g].size;
  const std::uint64_t bit = std::uint64_t{1} << (g % kWordBits);
  if (is_swept_in_blocks_[g]) {
    // Block by block, each for all ticks of the slice, so that its state stays in the first-level cache.
    for (std::uint32_t begin = 0; begin < size; begin += kBlockNeurons) {
      for (std::uint32_t k = 0; k < ticks; ++k) {
        advance_part(g, begin, std::min(begin + kBlockNeurons, size), k);
      }
    }
  }
  for (std::uint32_t k = 0; k < ticks; ++k) {
    std::uint64_t& with_input = ring_.groups_with_input(k, g / kWordBits);
    const bool is_idle = tick_ + k < idle_until_[g] && (with_input & bit) == 0 && !(injected_.any && k == 0);
    with_input &= ~bit;
    if (!is_swept_in_blocks_[g] && !is_idle) {
      advance_part(g, 0, size, k);
    }
  }
  std::uint64_t& word = busy_[g / kWordBits];
  word = idle_until_[g] == kNeverTick ? word & ~bit : word | bit;
}

// In update order; a same-tick synapse can give input to a group that is still to come.
void RingRunner::advance_groups(std::uint32_t ticks) noexcept {
  for (std::size_t w = 0; w < busy_.size(); ++w) {
    std::uint64_t to_come = ~std::uint64_t{0};
    while (true) {
      std::uint64_t work = injected_.any ? all_groups_[w] : busy_[w];
      for (std::uint32_t k = 0; k < ticks; ++k) {
        work |= ring_.groups_with_input(k, w);
      }
      work &= to_come;
      if (work == 0) {
        break;
      }
      const auto lowest = static_cast<std::uint32_t>(std::countr_zero(work));
      advance_group(static_cast<std::uint32_t>(w) * kWordBits + lowest, ticks);
      to_come = lowest + 1 == kWordBits ? 0 : ~std::uint64_t{0} << (lowest + 1);
    }
  }
}

std::uint32_t RingRunner::advance(std::uint64_t tick, std::uint64_t at_most, InjectedSpikes injected) noexcept {
  const auto ticks = static_cast<std::uint32_t>(std::min<std::uint64_t>(at_most, slice_));
  tick_ = tick;
  injected_ = injected;
  for (std::uint32_t k = 0; k < ticks; ++k) {
    spike_count_[k] = 0;
    deliver_due_rows(k);
  }
  advance_groups(ticks);
  for (std::uint32_t k = 0; k < ticks && !is_in_neuron_order_; ++k) {
    NeuronId* const first = spikes_.get() + std::size_t{k} * image_.header.neuron_count;
    std::sort(first, first + spike_count_[k]);
  }
  return ticks;
}

}  // namespace tectum
