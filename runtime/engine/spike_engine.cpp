#include "runtime/engine/spike_engine.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/engine/event_wheel.h"
#include "runtime/engine/group_parameters.h"
#include "runtime/engine/update_group.h"

namespace tectum {
namespace {

constexpr std::int32_t kMaxInjectedQuanta = 1 << 30;

std::uint64_t rows_in_flight(const SpikeImage& image) {
  std::uint64_t rows = 0;
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    const std::uint32_t end = image.row_begin[neuron + 1];
    rows += end == image.row_begin[neuron] ? 0 : std::uint64_t{image.segments[end - 1].delay_ticks} + 1;
  }
  return rows;
}

}  // namespace

struct SpikeEngine::Impl {
  Impl(const SpikeImage& loaded, const EngineOptions& options)
      : image(loaded),
        wheel(loaded.header.max_delay_ticks, rows_in_flight(loaded)),
        inputs(loaded.header.slot_count),
        slot_of_injection(loaded.header.slot_count),
        quantum(loaded.header.slot_count),
        group_of(loaded.header.neuron_count),
        is_injected(loaded.header.neuron_count),
        fired(loaded.header.neuron_count),
        spikes(loaded.header.neuron_count) {
    for (const GroupRecord& group : image.groups) {
      groups.push_back(make_update_group(image, group, options));
      const auto g = static_cast<std::uint32_t>(groups.size() - 1);
      std::fill_n(group_of.begin() + group.first_neuron, group.size, g);
      for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
        const double unit = GroupParameters(image, group).quantum(r);
        std::fill_n(quantum.begin() + group.first_slot + std::size_t{r} * group.size, group.size, unit);
      }
    }
  }

  void reset() noexcept;
  void step() noexcept;
  void deliver_due_rows() noexcept;
  void deliver_segment(std::uint32_t index) noexcept;
  void send(std::uint32_t neuron) noexcept;
  void update_group(std::size_t g) noexcept;

  SpikeImage image;
  std::vector<std::unique_ptr<UpdateGroup>> groups;
  EventWheel wheel;
  std::vector<std::int32_t> inputs;             // [slot]
  std::vector<std::int32_t> slot_of_injection;  // quanta injected for the next tick
  std::vector<double> quantum;                  // [slot]
  std::vector<std::uint32_t> group_of;          // [neuron]
  std::vector<std::uint8_t> is_injected;        // [neuron]: fires next tick whatever it does itself
  bool has_injections = false;
  std::vector<std::uint32_t> fired;
  std::vector<NeuronId> spikes;
  std::size_t spike_count = 0;
  std::uint64_t tick = 0;
  EngineCounters counters;
};

void SpikeEngine::Impl::reset() noexcept {
  wheel.clear();
  std::fill(inputs.begin(), inputs.end(), 0);
  std::fill(slot_of_injection.begin(), slot_of_injection.end(), 0);
  std::fill(is_injected.begin(), is_injected.end(), std::uint8_t{0});
  has_injections = false;
  for (const auto& group : groups) {
    group->reset();
  }
  spike_count = 0;
  tick = 0;
  counters = {};
}

void SpikeEngine::Impl::deliver_segment(std::uint32_t index) noexcept {
  const SegmentRecord& segment = image.segments[index];
  const std::uint32_t end = image.segments[index + 1].target_begin;
  const std::uint32_t weight_step = (segment.flags & kSegmentOneWeight) != 0 ? 0 : 1;
  const std::int32_t* weight = image.weights.data() + segment.weight_begin;
  for (std::uint32_t t = segment.target_begin; t < end; ++t, weight += weight_step) {
    std::int32_t& input = inputs[image.targets[t]];
    input = add_quanta(input, *weight);
  }
  counters.synaptic_events += end - segment.target_begin;
}

void SpikeEngine::Impl::deliver_due_rows() noexcept {
  std::uint32_t index = wheel.take(tick);
  while (index != EventWheel::kNone) {
    const EventWheel::Chunk& chunk = wheel.chunk(index);
    for (std::uint32_t k = 0; k < chunk.count; ++k) {
      const DueRow row = chunk.rows[k];
      deliver_segment(row.segment);
      if (row.segment + 1 < row.row_end) {
        const std::uint32_t delay = image.segments[row.segment].delay_ticks;
        wheel.push(tick + image.segments[row.segment + 1].delay_ticks - delay, {row.segment + 1, row.row_end});
      }
    }
    const std::uint32_t next = chunk.next;
    wheel.release(index);
    index = next;
  }
  if (has_injections) {
    for (std::size_t slot = 0; slot < inputs.size(); ++slot) {
      inputs[slot] = add_quanta(inputs[slot], slot_of_injection[slot]);
      slot_of_injection[slot] = 0;
    }
  }
}

void SpikeEngine::Impl::send(std::uint32_t neuron) noexcept {
  spikes[spike_count++] = NeuronId{neuron};
  std::uint32_t segment = image.row_begin[neuron];
  const std::uint32_t end = image.row_begin[neuron + 1];
  if (segment < end && image.segments[segment].delay_ticks == 0) {
    deliver_segment(segment++);
  }
  if (segment < end) {
    wheel.push(tick + image.segments[segment].delay_ticks, {segment, end});
  }
}

void SpikeEngine::Impl::update_group(std::size_t g) noexcept {
  const GroupRecord& record = image.groups[g];
  GroupTick now{tick, inputs.data() + record.first_slot, fired.data()};
  groups[g]->advance(now);
  if (!has_injections) {
    for (std::uint32_t k = 0; k < now.fired_count; ++k) {
      send(record.first_neuron + fired[k]);
    }
    return;
  }
  for (std::uint32_t k = 0; k < now.fired_count; ++k) {
    is_injected[record.first_neuron + fired[k]] = 1;
  }
  for (std::uint32_t neuron = record.first_neuron; neuron < record.first_neuron + record.size; ++neuron) {
    if (is_injected[neuron] != 0) {
      is_injected[neuron] = 0;
      send(neuron);
    }
  }
}

void SpikeEngine::Impl::step() noexcept {
  spike_count = 0;
  deliver_due_rows();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    update_group(g);
  }
  has_injections = false;
  std::sort(spikes.begin(), spikes.begin() + static_cast<std::ptrdiff_t>(spike_count));
  ++tick;
  ++counters.ticks;
  counters.spikes += spike_count;
}

SpikeEngine::SpikeEngine(const SpikeImage& image, const EngineOptions& options)
    : impl_(std::make_unique<Impl>(image, options)) {}
SpikeEngine::~SpikeEngine() = default;
SpikeEngine::SpikeEngine(SpikeEngine&&) noexcept = default;
SpikeEngine& SpikeEngine::operator=(SpikeEngine&&) noexcept = default;

void SpikeEngine::reset() noexcept { impl_->reset(); }
void SpikeEngine::step() noexcept { impl_->step(); }
std::uint64_t SpikeEngine::tick() const noexcept { return impl_->tick; }
std::span<const NeuronId> SpikeEngine::spikes() const noexcept { return {impl_->spikes.data(), impl_->spike_count}; }
const EngineCounters& SpikeEngine::counters() const noexcept { return impl_->counters; }

void SpikeEngine::set_field_active(NeuronId neuron, bool is_active) noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  const std::uint32_t g = impl_->group_of[n];
  impl_->groups[g]->set_active(n - impl_->image.groups[g].first_neuron, is_active);
}

void SpikeEngine::inject_spike(NeuronId neuron) noexcept {
  impl_->is_injected[static_cast<std::uint32_t>(neuron)] = 1;
  impl_->has_injections = true;
}

void SpikeEngine::inject_input(SlotId slot, double weight) noexcept {
  const auto s = static_cast<std::uint32_t>(slot);
  const double total = impl_->slot_of_injection[s] + std::nearbyint(weight / impl_->quantum[s]);
  const bool fits = total >= -kMaxInjectedQuanta && total <= kMaxInjectedQuanta;  // false for NaN, too
  if (!fits) {
    ++impl_->counters.saturated_inputs;
  }
  const double clipped = fits ? total : (total > 0 ? kMaxInjectedQuanta : (total < 0 ? -kMaxInjectedQuanta : 0));
  impl_->slot_of_injection[s] = static_cast<std::int32_t>(clipped);
  impl_->has_injections = true;
}

double SpikeEngine::probe(NeuronId neuron, std::uint32_t column) const noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  const std::uint32_t g = impl_->group_of[n];
  return impl_->groups[g]->probe(n - impl_->image.groups[g].first_neuron, column, impl_->tick);
}

}  // namespace tectum
