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

// As the vector instructions do it: the second where neither is larger.
float larger(float a, float b) noexcept { return a > b ? a : b; }

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
      refractory_(padded(size_)),
      awake_(may_sleep_ ? padded(size_) / kWordLanes : 0),
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

void MembraneGroup::store(std::uint32_t neuron, const State& state) noexcept {
  u_[neuron] = state.u;
  for (std::uint32_t c = 0; c < args_.current_count; ++c) {
    currents_[c * args_.stride + neuron] = state.currents[c];
  }
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

bool MembraneGroup::finish_tick(std::uint32_t neuron, std::int32_t* inputs, State& state) noexcept {
  for (std::uint32_t r = 0; r < args_.receptor_count; ++r) {
    std::int32_t& input = inputs[r * args_.input_stride + neuron];
    const auto quanta = static_cast<float>(input);
    input = 0;
    if (model_ == ModelKind::LifDelta) {
      state.u += args_.delta_quantum_mv[r] * quanta;
    } else {
      state.currents[r] += quanta;
    }
  }
  if (refractory_[neuron] > 0) {
    --refractory_[neuron];
    state.u = reset_mv_[has_own_thresholds_ ? neuron : 0];
    return false;
  }
  if (!(state.u >= threshold_mv_[has_own_thresholds_ ? neuron : 0])) {
    return false;
  }
  state.u = reset_mv_[has_own_thresholds_ ? neuron : 0];
  refractory_[neuron] = static_cast<std::uint16_t>(args_.refractory_ticks);
  if (model_ == ModelKind::Alif) {
    state.currents[args_.current_count - 1] += args_.adaptation_step_na;
  }
  return true;
}

bool MembraneGroup::may_sleep_now(std::uint32_t neuron, const State& state) const noexcept {
  float bound_mv = larger(state.u, 0.0F);
  for (std::uint32_t c = 0; c < args_.current_count; ++c) {
    bound_mv += larger(args_.peak[c] * state.currents[c], 0.0F);
  }
  return refractory_[neuron] == 0 && bound_mv < sleep_mv_[has_own_thresholds_ ? neuron : 0];
}

MembraneWord MembraneGroup::advance_lanes(MembraneTick now, std::uint32_t word, std::uint64_t lanes,
                                          std::uint64_t asleep, std::uint32_t done) noexcept {
  MembraneWord result{0, 0};
  for (; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
    const std::uint64_t bit = lanes & -lanes;
    const std::uint32_t neuron = word * kWordLanes + lane;
    State state = load(neuron);
    if ((asleep & bit) != 0) {
      leap(done - valid_after_[neuron], state);
    } else {
      if (now.removes_dust) {
        remove_dust(state);
      }
      propagate(step_.data(), state);
    }
    result.fired |= finish_tick(neuron, now.inputs, state) ? bit : 0;
    result.may_sleep |= may_sleep_now(neuron, state) ? bit : 0;
    store(neuron, state);
  }
  return result;
}

void MembraneGroup::advance_word(MembraneTick now, std::uint32_t word, GroupTick& tick) noexcept {
  const std::uint64_t awake = awake_[word];
  const std::uint64_t woken = tick.touched[word] & ~awake;
  const auto done = static_cast<std::uint32_t>(tick.tick + 1);
  MembraneWord result = advance_lanes(now, word, woken, woken, done);
  if (awake != 0) {
    const bool is_dense = static_cast<std::uint32_t>(std::popcount(awake)) >= dense_lanes_;
    const MembraneWord rest =
        is_dense ? kernels_.sweep_word(args_, now, word, awake) : advance_lanes(now, word, awake, 0, done);
    result.fired |= rest.fired;
    result.may_sleep |= rest.may_sleep;
  }
  awake_[word] = (awake | woken) & ~result.may_sleep;
  for (std::uint64_t left = result.may_sleep; left != 0; left &= left - 1) {
    valid_after_[word * kWordLanes + static_cast<std::uint32_t>(std::countr_zero(left))] = done;
  }
  for (std::uint64_t left = result.fired; left != 0; left &= left - 1) {
    tick.fire(word * kWordLanes + static_cast<std::uint32_t>(std::countr_zero(left)));
  }
}

void MembraneGroup::advance(GroupTick& tick) noexcept {
  const MembraneTick now{tick.inputs, tick.tick % kDustPeriodTicks == 0};
  if (!may_sleep_) {
    tick.fired_count += kernels_.sweep(args_, now, tick.begin, tick.end, tick.fired + tick.fired_count);
    return;
  }
  std::uint64_t left_awake = 0;
  for (std::uint32_t word = tick.begin / kWordLanes; word * kWordLanes < tick.end; ++word) {
    if ((awake_[word] | tick.touched[word]) != 0) {
      advance_word(now, word, tick);
      tick.touched[word] = 0;
      left_awake |= awake_[word];
    }
  }
  tick.idle_until = left_awake == 0 ? kNeverTick : 0;
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
