#include "runtime/engine/spike_engine.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "runtime/engine/event_wheel.h"
#include "runtime/engine/group_parameters.h"
#include "runtime/engine/input_ring.h"
#include "runtime/engine/update_group.h"

namespace tectum {
namespace {

constexpr std::int32_t kMaxInjectedQuanta = 1 << 30;
constexpr std::uint32_t kWordBits = 64;
// Ticks advanced at once: as many as the shortest delay, while their accumulators fit into the cache.
constexpr std::uint32_t kMaxSliceTicks = 16;
constexpr std::size_t kRingBytes = std::size_t{1} << 18U;
// Neurons whose state fits into the first-level cache.
constexpr std::uint32_t kBlockNeurons = 1024;

std::uint64_t rows_in_flight(const SpikeImage& image) {
  std::uint64_t rows = 0;
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    const std::uint32_t end = image.row_begin[neuron + 1];
    rows += end == image.row_begin[neuron] ? 0 : std::uint64_t{image.segments[end - 1].delay_ticks} + 1;
  }
  return rows;
}

// No spike of a slice of so many ticks arrives within the slice, but by same-tick synapses.
std::uint32_t slice_ticks(const SpikeImage& image) {
  std::uint32_t shortest = kMaxSliceTicks;
  for (std::size_t k = 0; k + 1 < image.segments.size(); ++k) {
    const std::uint32_t delay = image.segments[k].delay_ticks;
    shortest = delay == 0 ? shortest : std::min(shortest, delay);
  }
  const std::size_t fitting = kRingBytes / (sizeof(std::int32_t) * std::max(image.header.slot_count, 1U));
  return std::max(1U, std::min(shortest, static_cast<std::uint32_t>(fitting)));
}

std::vector<std::unique_ptr<UpdateGroup>> make_groups(const SpikeImage& image, const EngineOptions& options) {
  std::vector<std::unique_ptr<UpdateGroup>> groups;
  for (const GroupRecord& group : image.groups) {
    groups.push_back(make_update_group(image, group, options));
  }
  return groups;
}

}  // namespace

struct SpikeEngine::Impl {
  Impl(const SpikeImage& loaded, const EngineOptions& options)
      : image(loaded),
        groups(make_groups(image, options)),
        wheel(image.header.max_delay_ticks, rows_in_flight(image)),
        slice(slice_ticks(image)),
        ring(image, groups, slice),
        busy((groups.size() + kWordBits - 1) / kWordBits),
        all_groups(busy.size()),
        idle_until(groups.size()),
        injected((image.header.neuron_count + kWordBits - 1) / kWordBits),
        fired(image.header.neuron_count),
        spikes(std::make_unique_for_overwrite<NeuronId[]>(std::size_t{image.header.neuron_count} * slice)) {
    for (std::uint32_t g = 0; g < groups.size(); ++g) {
      const GroupRecord& group = image.groups[g];
      all_groups[g / kWordBits] |= std::uint64_t{1} << (g % kWordBits);
      first_neurons.emplace_back(group.first_neuron, g);
      is_swept_in_blocks.push_back(group.size > kBlockNeurons && groups[g]->is_divisible() &&
                                   !groups[g]->wants_marks());
    }
    is_in_neuron_order = std::is_sorted(first_neurons.begin(), first_neurons.end());
    std::sort(first_neurons.begin(), first_neurons.end());
    reset();
  }

  void reset() noexcept;
  std::uint32_t advance(std::uint64_t at_most) noexcept;
  void deliver_due_rows(std::uint32_t k) noexcept;
  void advance_groups(std::uint32_t ticks) noexcept;
  void advance_group(std::uint32_t g, std::uint32_t ticks) noexcept;
  void advance_part(std::uint32_t g, std::uint32_t begin, std::uint32_t end, std::uint32_t k) noexcept;
  void add_injected(const GroupRecord& record, GroupTick& now) noexcept;
  void send(std::uint32_t k, std::uint32_t neuron) noexcept;
  [[nodiscard]] std::uint32_t group_of(std::uint32_t neuron) const noexcept;

  SpikeImage image;
  std::vector<std::unique_ptr<UpdateGroup>> groups;
  EventWheel wheel;
  std::uint32_t slice;                                                 // most ticks of one advance()
  InputRing ring;                                                      // [tick of the slice]
  std::vector<std::uint64_t> busy;                                     // bit a group: to be advanced even without input
  std::vector<std::uint64_t> all_groups;                               // bit a group
  std::vector<std::uint64_t> idle_until;                               // of each group
  std::vector<bool> is_swept_in_blocks;                                // of each group
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first_neurons;  // (first neuron, group), ascending
  bool is_in_neuron_order = true;                                      // the groups, as listed
  std::vector<std::uint64_t> injected;  // bit a neuron: fires next tick whatever it does itself
  bool has_injected_spikes = false;
  std::vector<std::uint32_t> fired;
  std::unique_ptr<NeuronId[]> spikes;  // [tick of the slice][neuron], left unwritten until used
  std::array<std::uint32_t, kMaxSliceTicks> spike_count{};
  std::uint32_t last_ticks = 1;  // of the last advance()
  std::uint64_t tick = 0;
  EngineCounters counters;
};

void SpikeEngine::Impl::reset() noexcept {
  wheel.clear();
  ring.clear();
  std::fill(injected.begin(), injected.end(), std::uint64_t{0});
  has_injected_spikes = false;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    groups[g]->reset();
    busy[g / kWordBits] |= std::uint64_t{1} << (g % kWordBits);
    idle_until[g] = 0;
  }
  spike_count = {};
  last_ticks = 1;
  tick = 0;
  counters = {};
}

// Delivers what is due in tick k of the slice. A row that has another delay waits on for it, perhaps
// for a later tick of this very slice.
void SpikeEngine::Impl::deliver_due_rows(std::uint32_t k) noexcept {
  constexpr std::uint32_t kAhead = 2;
  std::uint32_t index = wheel.take(tick + k);
  while (index != EventWheel::kNone) {
    const EventWheel::Chunk& chunk = wheel.chunk(index);
    for (std::uint32_t r = 0; r < chunk.count; ++r) {
      if (r + kAhead < chunk.count) {
        ring.prefetch(chunk.rows[r + kAhead].segment);
      }
      const DueRow row = chunk.rows[r];
      const SegmentRecord& segment = image.segments[row.segment];
      const SegmentRecord& next = image.segments[row.segment + 1];
      ring.deliver(k, row.segment);
      counters.synaptic_events += next.target_begin - segment.target_begin;
      if (row.segment + 1 < row.row_end) {
        wheel.push(tick + k + next.delay_ticks - segment.delay_ticks, {row.segment + 1, row.row_end});
      }
    }
    const std::uint32_t next_chunk = chunk.next;
    wheel.release(index);
    index = next_chunk;
  }
}

void SpikeEngine::Impl::send(std::uint32_t k, std::uint32_t neuron) noexcept {
  spikes[std::size_t{k} * image.header.neuron_count + spike_count[k]++] = NeuronId{neuron};
  std::uint32_t segment = image.row_begin[neuron];
  const std::uint32_t end = image.row_begin[neuron + 1];
  if (segment < end && image.segments[segment].delay_ticks == 0) {
    ring.deliver(k, segment);
    counters.synaptic_events += image.segments[segment + 1].target_begin - image.segments[segment].target_begin;
    ++segment;
  }
  if (segment < end) {
    wheel.push(tick + k + image.segments[segment].delay_ticks, {segment, end});
  }
}

// Merges the neurons that fire by injection into those that fired by themselves.
void SpikeEngine::Impl::add_injected(const GroupRecord& record, GroupTick& now) noexcept {
  for (std::uint32_t f = 0; f < now.fired_count; ++f) {
    const std::uint32_t neuron = record.first_neuron + now.fired[f];
    injected[neuron / kWordBits] |= std::uint64_t{1} << (neuron % kWordBits);
  }
  now.fired_count = 0;
  for (std::uint32_t i = now.begin; i < now.end; ++i) {
    const std::uint32_t neuron = record.first_neuron + i;
    const std::uint64_t bit = std::uint64_t{1} << (neuron % kWordBits);
    if ((injected[neuron / kWordBits] & bit) != 0) {
      injected[neuron / kWordBits] &= ~bit;
      now.fire(i);
    }
  }
}

void SpikeEngine::Impl::advance_part(std::uint32_t g, std::uint32_t begin, std::uint32_t end,
                                     std::uint32_t k) noexcept {
  const GroupRecord& record = image.groups[g];
  GroupTick now{.tick = tick + k,
                .begin = begin,
                .end = end,
                .inputs = ring.inputs(k, g),
                .touched = ring.touched(k, g).data(),
                .touched_count = static_cast<std::uint32_t>(ring.touched(k, g).size()),
                .fired = fired.data()};
  groups[g]->advance(now);
  if (now.touched_count > 0) {
    ring.clear_touched(k, g);
  }
  if (has_injected_spikes && k == 0) {
    add_injected(record, now);
  }
  for (std::uint32_t f = 0; f < now.fired_count; ++f) {
    send(k, record.first_neuron + fired[f]);
  }
  idle_until[g] = now.idle_until;
}

void SpikeEngine::Impl::advance_group(std::uint32_t g, std::uint32_t ticks) noexcept {
  const std::uint32_t size = image.groups[g].size;
  const std::uint64_t bit = std::uint64_t{1} << (g % kWordBits);
  if (is_swept_in_blocks[g]) {
    // Block by block, each for all ticks of the slice, so that its state stays in the first-level cache.
    for (std::uint32_t begin = 0; begin < size; begin += kBlockNeurons) {
      for (std::uint32_t k = 0; k < ticks; ++k) {
        advance_part(g, begin, std::min(begin + kBlockNeurons, size), k);
      }
    }
  }
  for (std::uint32_t k = 0; k < ticks; ++k) {
    std::uint64_t& with_input = ring.groups_with_input(k, g / kWordBits);
    const bool is_idle = tick + k < idle_until[g] && (with_input & bit) == 0 && !(has_injected_spikes && k == 0);
    with_input &= ~bit;
    if (!is_swept_in_blocks[g] && !is_idle) {
      advance_part(g, 0, size, k);
    }
  }
  std::uint64_t& word = busy[g / kWordBits];
  word = idle_until[g] == kNeverTick ? word & ~bit : word | bit;
}

// In update order; a same-tick synapse can give input to a group that is still to come.
void SpikeEngine::Impl::advance_groups(std::uint32_t ticks) noexcept {
  for (std::size_t w = 0; w < busy.size(); ++w) {
    std::uint64_t to_come = ~std::uint64_t{0};
    while (true) {
      std::uint64_t work = has_injected_spikes ? all_groups[w] : busy[w];
      for (std::uint32_t k = 0; k < ticks; ++k) {
        work |= ring.groups_with_input(k, w);
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

std::uint32_t SpikeEngine::Impl::advance(std::uint64_t at_most) noexcept {
  const auto ticks = static_cast<std::uint32_t>(std::min<std::uint64_t>(at_most, slice));
  for (std::uint32_t k = 0; k < ticks; ++k) {
    spike_count[k] = 0;
    deliver_due_rows(k);
  }
  advance_groups(ticks);
  has_injected_spikes = false;
  for (std::uint32_t k = 0; k < ticks; ++k) {
    counters.spikes += spike_count[k];
    if (!is_in_neuron_order) {
      NeuronId* const first = spikes.get() + std::size_t{k} * image.header.neuron_count;
      std::sort(first, first + spike_count[k]);
    }
  }
  tick += ticks;
  counters.ticks += ticks;
  counters.dropped_rows = wheel.dropped();
  last_ticks = ticks;
  return ticks;
}

std::uint32_t SpikeEngine::Impl::group_of(std::uint32_t neuron) const noexcept {
  const auto after = std::upper_bound(first_neurons.begin(), first_neurons.end(), std::pair{neuron, ~std::uint32_t{0}});
  return std::prev(after)->second;
}

SpikeEngine::SpikeEngine(const SpikeImage& image, const EngineOptions& options)
    : impl_(std::make_unique<Impl>(image, options)) {}
SpikeEngine::~SpikeEngine() = default;
SpikeEngine::SpikeEngine(SpikeEngine&&) noexcept = default;
SpikeEngine& SpikeEngine::operator=(SpikeEngine&&) noexcept = default;

void SpikeEngine::reset() noexcept { impl_->reset(); }
void SpikeEngine::step() noexcept { impl_->advance(1); }
std::uint32_t SpikeEngine::advance(std::uint64_t at_most) noexcept { return impl_->advance(at_most); }
std::uint64_t SpikeEngine::tick() const noexcept { return impl_->tick; }
std::span<const NeuronId> SpikeEngine::spikes() const noexcept { return spikes(impl_->last_ticks - 1); }
std::span<const NeuronId> SpikeEngine::spikes(std::uint32_t k) const noexcept {
  return {impl_->spikes.get() + std::size_t{k} * impl_->image.header.neuron_count, impl_->spike_count[k]};
}
const EngineCounters& SpikeEngine::counters() const noexcept { return impl_->counters; }

void SpikeEngine::set_field_active(NeuronId neuron, bool is_active) noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  const std::uint32_t g = impl_->group_of(n);
  impl_->groups[g]->set_active(n - impl_->image.groups[g].first_neuron, is_active);
  impl_->busy[g / kWordBits] |= std::uint64_t{1} << (g % kWordBits);
  impl_->idle_until[g] = 0;
}

void SpikeEngine::inject_spike(NeuronId neuron) noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  impl_->injected[n / kWordBits] |= std::uint64_t{1} << (n % kWordBits);
  impl_->has_injected_spikes = true;
}

void SpikeEngine::inject_input(SlotId slot, double weight) noexcept {
  const auto s = static_cast<std::uint32_t>(slot);
  const SlotRange& range = impl_->ring.range_of(s);
  const double quantum = GroupParameters(impl_->image, impl_->image.groups[range.group]).quantum(range.receptor);
  // Between ticks the accumulators hold nothing but what was injected.
  const std::int32_t before = impl_->ring.value(0, s);
  const double total = before + std::nearbyint(weight / quantum);
  const bool fits = total >= -kMaxInjectedQuanta && total <= kMaxInjectedQuanta;  // false for NaN, too
  if (!fits) {
    ++impl_->counters.saturated_inputs;
  }
  const double clipped = fits ? total : (total > 0 ? kMaxInjectedQuanta : (total < 0 ? -kMaxInjectedQuanta : before));
  impl_->ring.add(0, s, static_cast<std::int32_t>(clipped) - before);
}

double SpikeEngine::probe(NeuronId neuron, std::uint32_t column) const noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  const std::uint32_t g = impl_->group_of(n);
  return impl_->groups[g]->probe(n - impl_->image.groups[g].first_neuron, column, impl_->tick);
}

}  // namespace tectum
