#include "runtime/engine/membrane_group.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "runtime/engine/group_parameters.h"

namespace tectum {
namespace {

constexpr std::uint32_t kWordLanes = 64;
constexpr std::uint64_t kDustPeriodTicks = 64;

// 0 for anything smaller than 2^-63: one of the two highest exponent bits is set from there on.
float without_dust(float value) noexcept {
  constexpr std::uint32_t kLargeExponent = 0x60000000U;
  return (std::bit_cast<std::uint32_t>(value) & kLargeExponent) != 0 ? value : 0.0F;
}

float normal_or_zero(double value) {
  return std::abs(value) < static_cast<double>(std::numeric_limits<float>::min()) ? 0.0F : static_cast<float>(value);
}

// A propagator entry whose currents are counted in J instead of nA.
void append_scaled(std::span<const float> entry, const std::vector<double>& unit, std::vector<float>& scaled) {
  const std::size_t first = scaled.size();
  scaled.insert(scaled.end(), entry.begin(), entry.end());
  for (std::size_t c = 0; c < unit.size(); ++c) {
    scaled[first + 1 + c] = normal_or_zero(static_cast<double>(entry[1 + c]) * unit[c]);
  }
}

std::size_t padded(std::uint32_t size) { return (std::size_t{size} + kWordLanes - 1) / kWordLanes * kWordLanes; }

// Where the list of a part that starts at `neuron` begins: whole vectors are read and written past its end.
std::size_t picked_begin(std::uint32_t neuron) {
  return padded(neuron) + std::size_t{neuron} / (kWordLanes * kWordLanes) * kWordLanes;
}

// std::popcount is a call on processors that may lack the instruction.
std::uint32_t count_bits(std::uint64_t word) noexcept {
  word -= (word >> 1U) & 0x5555555555555555ULL;
  word = (word & 0x3333333333333333ULL) + ((word >> 2U) & 0x3333333333333333ULL);
  word = (word + (word >> 4U)) & 0x0F0F0F0F0F0F0F0FULL;
  return static_cast<std::uint32_t>((word * 0x0101010101010101ULL) >> 56U);
}

// In a word with few neurons awake, going through them one by one is faster than the whole vectors.
std::uint32_t dense_lanes(SweepStrategy strategy) {
  constexpr std::uint32_t kWorthAVector = 12;
  switch (strategy) {
    case SweepStrategy::Dense:
      return 1;
    case SweepStrategy::Sparse:
      return kWordLanes + 1;
    case SweepStrategy::Automatic:
      break;
  }
  return kWorthAVector;
}

}  // namespace

MembraneGroup::MembraneGroup(const SpikeImage& image, const GroupRecord& group, const EngineOptions& options)
    : size_(group.size),
      model_(group.model),
      may_sleep_((group.flags & kGroupMaySleep) != 0),
      dense_lanes_(dense_lanes(options.sweep)),
      u_(padded(size_)),
      refractory_(padded(size_) + 1),  // the gather of the last counter reads one more
      awake_(may_sleep_ ? padded(size_) / kWordLanes : 0),
      awake_words_((awake_.size() + kWordLanes - 1) / kWordLanes),
      picked_(may_sleep_ ? std::make_unique_for_overwrite<std::uint32_t[]>(picked_begin(size_) + 2 * kWordLanes)
                         : nullptr),
      valid_after_(may_sleep_ ? padded(size_) : 0) {
  derive_constants(image, group);
  derive_thresholds(image, group);
  currents_.resize(args_.current_count * padded(size_));
  kernels_ = membrane_kernels(options.simd, model_, args_.current_count, has_own_thresholds_);
  args_.u = u_.data();
  args_.currents = currents_.data();
  args_.refractory = refractory_.data();
  args_.stride = padded(size_);
  args_.threshold_mv = threshold_mv_.data();
  args_.reset_mv = reset_mv_.data();
  args_.sleep_mv = sleep_mv_.data();
  args_.shared_threshold_mv = threshold_mv_[0];
  args_.shared_reset_mv = reset_mv_[0];
  args_.shared_sleep_mv = sleep_mv_[0];
  args_.input_stride = size_;
  args_.size = size_;
  MembraneGroup::reset();
}

void MembraneGroup::derive_constants(const SpikeImage& image, const GroupRecord& group) {
  const GroupParameters parameters(image, group);
  args_.receptor_count = group.receptor_count;
  args_.current_count = current_count(model_, group.receptor_count);
  args_.refractory_ticks = parameters.ticks(lif_parameter::kRefractory);
  if (model_ == ModelKind::Alif) {
    args_.adaptation_step_na = static_cast<float>(parameters.value(lif_parameter::kAdaptationStep));
  }
  for (std::uint32_t r = 0; model_ == ModelKind::LifDelta && r < group.receptor_count; ++r) {
    args_.delta_quantum_mv[r] = static_cast<float>(parameters.quantum(r));
  }
  for (std::uint32_t c = 0; c < args_.current_count; ++c) {
    unit_.push_back(c < group.receptor_count ? parameters.quantum(c) : 1.0);
  }
  derive_leaps(image.tables.subspan(group.table_begin, group.table_count),
               PropagatorTable::of(args_.current_count, group.size));
}

void MembraneGroup::derive_leaps(std::span<const float> table, const PropagatorTable& layout) {
  digit_bits_ = layout.digit_bits;
  append_scaled(table.first(layout.entry_size()), unit_, step_);
  args_.decay = step_[0];
  for (std::uint32_t c = 0; c < args_.current_count; ++c) {
    args_.gain[c] = step_[1 + c];
    args_.current_decay[c] = step_[1 + args_.current_count + c];
    args_.peak[c] = normal_or_zero(static_cast<double>(table[layout.peaks_begin() + c]) * unit_[c]);
  }
  for (std::size_t at = layout.levels_begin(); at < table.size(); at += layout.entry_size()) {
    append_scaled(table.subspan(at, layout.entry_size()), unit_, levels_);
  }
}

void MembraneGroup::derive_thresholds(const SpikeImage& image, const GroupRecord& group) {
  using namespace lif_parameter;
  // A margin of 2^-10 covers the rounding of the leaps.
  constexpr float kSleepShare = 1.0F - 1.0F / 1024.0F;
  const GroupParameters parameters(image, group);
  for (const std::uint32_t p : {kRestV, kThresholdV, kResetV, kBias}) {
    has_own_thresholds_ = has_own_thresholds_ || parameters.varies(p);
  }
  for (std::uint32_t i = 0; i < (has_own_thresholds_ ? size_ : 1); ++i) {
    const double rest_mv = parameters.value(kRestV, i) + parameters.value(kResistance) * parameters.value(kBias, i);
    const auto threshold_mv = static_cast<float>(parameters.value(kThresholdV, i) - rest_mv);
    rest_mv_.push_back(rest_mv);
    threshold_mv_.push_back(threshold_mv);
    reset_mv_.push_back(static_cast<float>(parameters.value(kResetV, i) - rest_mv));
    sleep_mv_.push_back(threshold_mv > 0 ? threshold_mv * kSleepShare : -1.0F);
  }
  for (std::uint32_t i = 0; i < size_; ++i) {
    const double rest_mv = rest_mv_[has_own_thresholds_ ? i : 0];
    initial_mv_.push_back(static_cast<float>(parameters.value(kInitialV, i) - rest_mv));
  }
  for (AlignedVector<float>* values : {&threshold_mv_, &reset_mv_, &sleep_mv_}) {
    values->resize(has_own_thresholds_ ? padded(size_) : 1);
  }
}

void MembraneGroup::reset() noexcept {
  for (std::uint32_t i = 0; i < size_; ++i) {
    u_[i] = initial_mv_[i];
  }
  std::fill(currents_.begin(), currents_.end(), 0.0F);
  std::fill(refractory_.begin(), refractory_.end(), std::uint16_t{0});
  for (std::size_t w = 0; w < awake_.size(); ++w) {
    const std::size_t left = size_ - w * kWordLanes;
    awake_[w] = left >= kWordLanes ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
    awake_words_[w / kWordLanes] |= std::uint64_t{1} << (w % kWordLanes);
  }
}

MembraneGroup::State MembraneGroup::load(std::uint32_t neuron) const noexcept {
  State state;
  state.u = u_[neuron];
  for (std::uint32_t c = 0; c < args_.current_count; ++c) {
    state.currents[c] = currents_[c * args_.stride + neuron];
  }
  return state;
}

void MembraneGroup::remove_dust(State& state) const noexcept {
  state.u = without_dust(state.u);
  for (std::uint32_t c = 0; c < args_.current_count; ++c) {
    state.currents[c] = without_dust(state.currents[c]);
  }
}

void MembraneGroup::propagate(const float* entry, State& state) const noexcept {
  const std::uint32_t count = args_.current_count;
  float u = entry[0] * state.u;
  for (std::uint32_t c = 0; c < count; ++c) {
    u += entry[1 + c] * state.currents[c];
    state.currents[c] = entry[1 + count + c] * state.currents[c];
  }
  state.u = u;
}

void MembraneGroup::leap(std::uint32_t ticks, State& state) const noexcept {
  const std::size_t entry_size = 1 + 2 * std::size_t{args_.current_count};
  const std::uint32_t digits = 1U << digit_bits_;
  const float* level = levels_.data();
  while (ticks != 0) {
    const std::uint32_t digit = ticks % digits;
    if (digit != 0) {
      propagate(level + digit * entry_size, state);
    }
    level += digits * entry_size;
    ticks >>= digit_bits_;
  }
  remove_dust(state);
}

void MembraneGroup::set_awake(std::uint32_t neuron, bool is_awake) noexcept {
  const std::uint32_t word = neuron / kWordLanes;
  const std::uint64_t lane = std::uint64_t{1} << (neuron % kWordLanes);
  awake_[word] = is_awake ? awake_[word] | lane : awake_[word] & ~lane;
  const std::uint64_t bit = std::uint64_t{1} << (word % kWordLanes);
  std::uint64_t& summary = awake_words_[word / kWordLanes];
  summary = awake_[word] != 0 ? summary | bit : summary & ~bit;
}

void MembraneGroup::sweep_awake(MembraneTick now, std::uint32_t word, GroupTick& tick) noexcept {
  const MembraneWord result = kernels_.sweep_word(args_, now, word, awake_[word]);
  for (std::uint64_t left = result.may_sleep; left != 0; left &= left - 1) {
    const std::uint32_t neuron = word * kWordLanes + static_cast<std::uint32_t>(std::countr_zero(left));
    valid_after_[neuron] = static_cast<std::uint32_t>(tick.tick + 1);
    set_awake(neuron, false);
  }
  for (std::uint64_t left = result.fired; left != 0; left &= left - 1) {
    tick.fire(word * kWordLanes + static_cast<std::uint32_t>(std::countr_zero(left)));
  }
}

void MembraneGroup::advance_picked(MembraneTick now, MembraneKernels::Picked kernel,
                                   std::span<const std::uint32_t> neurons, GroupTick& tick) noexcept {
  const MembraneLeaps leaps{levels_.data(), digit_bits_, valid_after_.data()};
  const bool was_awake = kernel == kernels_.step;
  for (std::size_t first = 0; first < neurons.size(); first += kWordLanes) {
    const auto batch = neurons.subspan(first, std::min<std::size_t>(kWordLanes, neurons.size() - first));
    const auto count = static_cast<std::uint32_t>(batch.size());
    const MembraneWord result =
        kernel(args_, now, leaps, batch.data(), count, static_cast<std::uint32_t>(tick.tick + 1));
    const std::uint64_t all = ~std::uint64_t{0} >> (kWordLanes - count);
    for (std::uint64_t left = all & (was_awake ? result.may_sleep : ~result.may_sleep); left != 0; left &= left - 1) {
      set_awake(batch[static_cast<std::size_t>(std::countr_zero(left))], !was_awake);
    }
    for (std::uint64_t left = result.fired; left != 0; left &= left - 1) {
      tick.fire(batch[static_cast<std::size_t>(std::countr_zero(left))]);
    }
  }
}

void MembraneGroup::advance(GroupTick& tick) noexcept {
  const MembraneTick now{tick.inputs, tick.tick % kDustPeriodTicks == 0};
  if (!may_sleep_) {
    tick.fired_count = kernels_.sweep(args_, now, tick.begin, tick.end, tick.fired);
    return;
  }
  // Who sleeps is settled before anyone moves: a neuron takes one step or one leap.
  std::uint32_t* const picked = picked_.get() + picked_begin(tick.begin);
  std::uint32_t asleep_count = 0;
  for (std::uint32_t k = 0; k < tick.touched_count; ++k) {
    const std::uint32_t neuron = tick.touched[k];
    picked[asleep_count] = neuron;
    asleep_count += static_cast<std::uint32_t>(~(awake_[neuron / kWordLanes] >> (neuron % kWordLanes)) & 1U);
  }
  std::uint32_t picked_count = asleep_count;
  const std::size_t first_summary = tick.begin / (kWordLanes * kWordLanes);
  const std::size_t last_summary = (tick.end + kWordLanes * kWordLanes - 1) / (kWordLanes * kWordLanes);
  for (std::size_t w = first_summary; w < last_summary; ++w) {
    for (std::uint64_t left = awake_words_[w]; left != 0; left &= left - 1) {
      const auto word = static_cast<std::uint32_t>(w * kWordLanes) + static_cast<std::uint32_t>(std::countr_zero(left));
      if (count_bits(awake_[word]) >= dense_lanes_) {
        sweep_awake(now, word, tick);
        continue;
      }
      for (std::uint64_t lanes = awake_[word]; lanes != 0; lanes &= lanes - 1) {
        picked[picked_count++] = word * kWordLanes + static_cast<std::uint32_t>(std::countr_zero(lanes));
      }
    }
  }
  advance_picked(now, kernels_.step, {picked + asleep_count, picked_count - asleep_count}, tick);
  advance_picked(now, kernels_.leap, {picked, asleep_count}, tick);
  std::sort(tick.fired, tick.fired + tick.fired_count);
  std::uint64_t still_awake = 0;
  for (std::size_t w = first_summary; w < last_summary; ++w) {
    still_awake |= awake_words_[w];
  }
  tick.idle_until = still_awake == 0 ? kNeverTick : 0;
}

std::vector<const void*> MembraneGroup::hot_arrays() const {
  std::vector<const void*> arrays = {u_.data(), valid_after_.data()};
  for (std::uint32_t c = 0; c < args_.current_count; ++c) {
    arrays.push_back(currents_.data() + c * args_.stride);
  }
  return arrays;
}

double MembraneGroup::probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept {
  State state = load(neuron);
  const bool is_asleep = may_sleep_ && ((awake_[neuron / kWordLanes] >> (neuron % kWordLanes)) & 1U) == 0;
  if (is_asleep) {
    leap(static_cast<std::uint32_t>(tick) - valid_after_[neuron], state);
  }
  if (column == 0) {
    return static_cast<double>(state.u) + rest_mv_[has_own_thresholds_ ? neuron : 0];
  }
  // alif lists w before the receptors' currents, which it keeps last.
  std::uint32_t c = column - 1;
  if (model_ == ModelKind::Alif) {
    c = column == 1 ? args_.current_count - 1 : column - 2;
  }
  return c < args_.current_count ? static_cast<double>(state.currents[c]) * unit_[c] : 0;
}

}  // namespace tectum
