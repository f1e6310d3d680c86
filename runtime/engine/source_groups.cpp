#include "runtime/engine/source_groups.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "runtime/engine/group_parameters.h"
#include "runtime/image/philox.h"

namespace tectum {

FieldGroup::FieldGroup(const SpikeImage& image, const GroupRecord& group)
    : next_tick_(group.size), is_active_(group.size) {
  constexpr double kLongestPeriodTicks = 4e9;
  const GroupParameters parameters(image, group);
  for (std::uint32_t i = 0; i < group.size; ++i) {
    const double period_ticks = 1000.0 / parameters.value(source_parameter::kRate, i) / parameters.tick_ms();
    period_ticks_.push_back(
        static_cast<std::uint32_t>(std::llround(std::clamp(period_ticks, 1.0, kLongestPeriodTicks))));
  }
}

void FieldGroup::reset() noexcept {
  std::fill(next_tick_.begin(), next_tick_.end(), std::uint64_t{0});
  std::fill(is_active_.begin(), is_active_.end(), std::uint8_t{0});
}

void FieldGroup::advance(GroupTick& tick) noexcept {
  tick.idle_until = kNeverTick;
  for (std::uint32_t i = 0; i < is_active_.size(); ++i) {
    if (is_active_[i] == 0) {
      continue;
    }
    if (tick.tick >= next_tick_[i]) {
      tick.fire(i);
      next_tick_[i] = tick.tick + period_ticks_[i];
    }
    tick.idle_until = std::min(tick.idle_until, next_tick_[i]);
  }
}

double FieldGroup::probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t) const noexcept {
  return column == 0 ? is_active_[neuron] : 0;
}

void FieldGroup::set_active(std::uint32_t neuron, bool is_active) noexcept {
  if (is_active && is_active_[neuron] == 0) {
    next_tick_[neuron] = 0;
  }
  is_active_[neuron] = static_cast<std::uint8_t>(is_active);
}

PoissonGroup::PoissonGroup(const SpikeImage& image, const GroupRecord& group)
    : key_(image.header.seed),
      name_hash_(name_hash(image.name(image.populations[group.population].name))),
      first_index_(group.first_neuron - image.populations[group.population].first_neuron),
      draw_count_(group.size),
      second_half_(group.size),
      fires_(group.size),
      next_(group.size),
      buckets_(kBuckets) {
  const GroupParameters parameters(image, group);
  std::map<double, std::uint32_t> index_of_rate;
  for (std::uint32_t i = 0; i < group.size; ++i) {
    const double rate_hz = parameters.value(source_parameter::kRate, i);
    const auto [entry, is_new] = index_of_rate.emplace(rate_hz, static_cast<std::uint32_t>(chances_.size()));
    chance_of_.push_back(entry->second);
    if (is_new) {
      Chance chance{rate_hz, {}, {}, {}};
      double silent = 1.0 - std::min(rate_hz * parameters.tick_ms() * 1e-3, 1.0);
      for (double& power : chance.silent) {
        power = silent;
        silent *= silent;
      }
      chances_.push_back(chance);
    }
  }
  for (Chance& chance : chances_) {
    if (chances_.size() <= kTabledRates) {
      chance.make_tables();
    }
  }
  PoissonGroup::reset();
}

double PoissonGroup::Chance::silent_for_ticks(std::uint32_t wait) const noexcept {
  double product = 1.0;  // in the order in which wait_of() multiplies, so that the two agree to the last bit
  for (std::uint32_t b = kWaitBits; b-- > 0;) {
    product *= (wait >> b & 1U) != 0 ? silent[b] : 1.0;
  }
  return product;
}

void PoissonGroup::Chance::make_tables() {
  std::vector<double> chances;
  for (std::uint32_t wait = 0; wait <= kMaxWait; ++wait) {
    chances.push_back(silent_for_ticks(wait));
  }
  if (std::adjacent_find(chances.begin(), chances.end(), std::less_equal<>()) != chances.end()) {
    return;
  }
  for (std::uint32_t j = 0; j <= kGuideSize; ++j) {
    guide.push_back(static_cast<std::uint16_t>(wait_of(std::min(1.0, (j + 1.0) / kGuideSize))));
  }
  silent_for = std::move(chances);
}

std::uint32_t PoissonGroup::Chance::wait_of(double left) const noexcept {
  std::uint32_t wait = 0;
  if (!silent_for.empty()) {
    wait = guide[static_cast<std::uint32_t>(left * kGuideSize)];
    while (wait < kMaxWait && silent_for[wait + 1] >= left) {
      ++wait;
    }
    return wait;
  }
  double product = 1.0;
  for (std::uint32_t b = kWaitBits; b-- > 0;) {
    const double longer = product * silent[b];
    if (longer >= left) {
      product = longer;
      wait += 1U << b;
    }
  }
  return wait;
}

std::uint32_t PoissonGroup::draw_wait(std::uint32_t neuron) noexcept {
  const std::uint64_t draw = draw_count_[neuron]++;
  std::uint64_t bits = second_half_[neuron];
  if (draw % 2 == 0) {
    const std::uint64_t block = draw / 2;
    const PhiloxWords words = philox4x32(
        key_, {static_cast<std::uint32_t>(block), first_index_ + neuron, static_cast<std::uint32_t>(name_hash_),
               static_cast<std::uint32_t>((name_hash_ ^ block) >> 32U)});
    bits = (std::uint64_t{words[1]} << 32U) | words[0];
    second_half_[neuron] = (std::uint64_t{words[3]} << 32U) | words[2];
  }
  const double left = static_cast<double>((bits >> 11U) + 1) * 0x1p-53;  // 1 - u, in (0, 1]
  return chances_[chance_of_[neuron]].wait_of(left);
}

void PoissonGroup::schedule(std::uint32_t neuron, std::uint64_t tick) noexcept {
  const std::uint32_t wait = draw_wait(neuron);
  fires_[neuron] = static_cast<std::uint8_t>(wait < kMaxWait);
  std::uint32_t& bucket = buckets_[(tick + wait) % kBuckets];
  next_[neuron] = bucket;
  bucket = neuron;
}

void PoissonGroup::reset() noexcept {
  std::fill(buckets_.begin(), buckets_.end(), kNone);
  std::fill(draw_count_.begin(), draw_count_.end(), std::uint64_t{0});
  for (std::uint32_t i = 0; i < next_.size(); ++i) {
    if (chances_[chance_of_[i]].rate_hz > 0) {
      schedule(i, 0);
    }
  }
}

void PoissonGroup::advance(GroupTick& tick) noexcept {
  // A neuron whose draw is due may be due again in this same tick, hence the outer loop.
  std::uint32_t& bucket = buckets_[tick.tick % kBuckets];
  while (bucket != kNone) {
    std::uint32_t neuron = bucket;
    bucket = kNone;
    while (neuron != kNone) {
      const std::uint32_t following = next_[neuron];
      if (fires_[neuron] != 0) {
        tick.fire(neuron);
        schedule(neuron, tick.tick + 1);
      } else {
        schedule(neuron, tick.tick);
      }
      neuron = following;
    }
  }
  std::sort(tick.fired, tick.fired + tick.fired_count);
}

double PoissonGroup::probe(std::uint32_t, std::uint32_t, std::uint64_t) const noexcept { return 0; }

SpikeListGroup::SpikeListGroup(const SpikeImage& image, const GroupRecord& group)
    : spikes_(image.source_spikes.subspan(group.data_begin, group.data_count)) {}

void SpikeListGroup::advance(GroupTick& tick) noexcept {
  while (next_ < spikes_.size() && spikes_[next_] == tick.tick) {
    tick.fire(spikes_[next_ + 1]);
    next_ += 2;
  }
  tick.idle_until = next_ < spikes_.size() ? spikes_[next_] : kNeverTick;
}

double SpikeListGroup::probe(std::uint32_t, std::uint32_t, std::uint64_t) const noexcept { return 0; }

}  // namespace tectum
