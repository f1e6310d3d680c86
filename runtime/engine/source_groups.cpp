#include "runtime/engine/source_groups.h"

#include <algorithm>
#include <cmath>

#include "runtime/engine/group_parameters.h"
#include "runtime/engine/philox.h"

namespace tectum {

FieldGroup::FieldGroup(const SpikeImage& image, const GroupRecord& group)
    : wait_ticks_(group.size), is_active_(group.size) {
  constexpr double kLongestPeriodTicks = 4e9;
  const GroupParameters parameters(image, group);
  for (std::uint32_t i = 0; i < group.size; ++i) {
    const double period_ticks = 1000.0 / parameters.value(source_parameter::kRate, i) / parameters.tick_ms();
    period_ticks_.push_back(
        static_cast<std::uint32_t>(std::llround(std::clamp(period_ticks, 1.0, kLongestPeriodTicks))));
  }
}

void FieldGroup::reset() noexcept {
  std::fill(wait_ticks_.begin(), wait_ticks_.end(), 0U);
  std::fill(is_active_.begin(), is_active_.end(), std::uint8_t{0});
}

void FieldGroup::advance(GroupTick& tick) noexcept {
  for (std::uint32_t i = 0; i < is_active_.size(); ++i) {
    if (is_active_[i] == 0) {
      continue;
    }
    if (wait_ticks_[i] == 0) {
      tick.fire(i);
      wait_ticks_[i] = period_ticks_[i];
    }
    --wait_ticks_[i];
  }
}

double FieldGroup::probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t) const noexcept {
  return column == 0 ? is_active_[neuron] : 0;
}

void FieldGroup::set_active(std::uint32_t neuron, bool is_active) noexcept {
  if (is_active && is_active_[neuron] == 0) {
    wait_ticks_[neuron] = 0;
  }
  is_active_[neuron] = static_cast<std::uint8_t>(is_active);
}

PoissonGroup::PoissonGroup(const SpikeImage& image, const GroupRecord& group)
    : key_(image.header.seed),
      name_hash_(name_hash(image.name(image.populations[group.population].name))),
      first_index_(group.first_neuron - image.populations[group.population].first_neuron) {
  const GroupParameters parameters(image, group);
  for (std::uint32_t i = 0; i < group.size; ++i) {
    const double probability = parameters.value(source_parameter::kRate, i) * parameters.tick_ms() * 1e-3;
    fires_below_.push_back(static_cast<std::uint64_t>(std::llround(std::min(probability, 1.0) * 0x1p32)));
  }
}

void PoissonGroup::advance(GroupTick& tick) noexcept {
  const std::uint64_t block = tick.tick / 4;
  const auto word = static_cast<std::size_t>(tick.tick % 4);
  for (std::uint32_t i = 0; i < fires_below_.size(); ++i) {
    const PhiloxWords counter = {static_cast<std::uint32_t>(block), first_index_ + i,
                                 static_cast<std::uint32_t>(name_hash_),
                                 static_cast<std::uint32_t>((name_hash_ ^ block) >> 32U)};
    if (philox4x32(key_, counter)[word] < fires_below_[i]) {
      tick.fire(i);
    }
  }
}

double PoissonGroup::probe(std::uint32_t, std::uint32_t, std::uint64_t) const noexcept { return 0; }

SpikeListGroup::SpikeListGroup(const SpikeImage& image, const GroupRecord& group)
    : spikes_(image.source_spikes.subspan(group.data_begin, group.data_count)) {}

void SpikeListGroup::advance(GroupTick& tick) noexcept {
  while (next_ < spikes_.size() && spikes_[next_] == tick.tick) {
    tick.fire(spikes_[next_ + 1]);
    next_ += 2;
  }
}

double SpikeListGroup::probe(std::uint32_t, std::uint32_t, std::uint64_t) const noexcept { return 0; }

}  // namespace tectum
