#include "runtime/engine/membrane_group.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "runtime/engine/group_parameters.h"

namespace tectum {
namespace {

// 0 for anything smaller than 2^-63: one of the two highest exponent bits is set from there on.
float without_dust(float value) noexcept {
  constexpr std::uint32_t kLargeExponent = 0x60000000U;
  return (std::bit_cast<std::uint32_t>(value) & kLargeExponent) != 0 ? value : 0.0F;
}

float normal_or_zero(double value) {
  return std::abs(value) < static_cast<double>(std::numeric_limits<float>::min()) ? 0.0F : static_cast<float>(value);
}

float pick(const std::vector<float>& values, std::uint32_t neuron) noexcept {
  return values.size() == 1 ? values[0] : values[neuron];
}

// A propagator entry whose currents are counted in J instead of nA.
std::vector<float> scaled_entry(std::span<const float> entry, const std::vector<double>& unit) {
  std::vector<float> scaled(entry.begin(), entry.end());
  for (std::size_t c = 0; c < unit.size(); ++c) {
    scaled[1 + c] = normal_or_zero(static_cast<double>(entry[1 + c]) * unit[c]);
  }
  return scaled;
}

MembraneConstants derive_constants(const SpikeImage& image, const GroupRecord& group) {
  const GroupParameters parameters(image, group);
  MembraneConstants constants;
  constants.model = group.model;
  constants.size = group.size;
  constants.receptor_count = group.receptor_count;
  constants.current_count = current_count(group.model, group.receptor_count);
  constants.refractory_ticks = parameters.ticks(lif_parameter::kRefractory);
  constants.may_sleep = (group.flags & kGroupMaySleep) != 0;
  if (group.model == ModelKind::Alif) {
    constants.adaptation_step_na = static_cast<float>(parameters.value(lif_parameter::kAdaptationStep));
  }
  for (std::uint32_t c = 0; c < constants.current_count; ++c) {
    constants.unit.push_back(c < group.receptor_count ? parameters.quantum(c) : 1.0);
  }
  for (std::uint32_t r = 0; group.model == ModelKind::LifDelta && r < group.receptor_count; ++r) {
    constants.delta_quantum_mv.push_back(static_cast<float>(parameters.quantum(r)));
  }
  const PropagatorTable layout{constants.current_count};
  const auto table = image.tables.subspan(group.table_begin, group.table_count);
  constants.step = scaled_entry(table.first(layout.entry_size()), constants.unit);
  for (std::uint32_t c = 0; c < constants.current_count; ++c) {
    constants.peak.push_back(normal_or_zero(static_cast<double>(table[layout.peaks_begin() + c]) * constants.unit[c]));
  }
  for (std::size_t at = layout.levels_begin(); at < table.size(); at += layout.entry_size()) {
    const std::vector<float> entry = scaled_entry(table.subspan(at, layout.entry_size()), constants.unit);
    constants.levels.insert(constants.levels.end(), entry.begin(), entry.end());
  }
  return constants;
}

MembraneThresholds derive_thresholds(const SpikeImage& image, const GroupRecord& group) {
  using namespace lif_parameter;
  // A margin of 2^-10 covers the rounding of the closed form.
  constexpr float kSleepShare = 1.0F - 1.0F / 1024.0F;
  const GroupParameters parameters(image, group);
  const bool varies = parameters.varies(kRestV) || parameters.varies(kBias) || parameters.varies(kThresholdV) ||
                      parameters.varies(kResetV) || parameters.varies(kInitialV);
  MembraneThresholds thresholds;
  for (std::uint32_t i = 0; i < (varies ? group.size : 1); ++i) {
    const double rest_mv = parameters.value(kRestV, i) + parameters.value(kResistance) * parameters.value(kBias, i);
    const auto threshold_mv = static_cast<float>(parameters.value(kThresholdV, i) - rest_mv);
    thresholds.rest_mv.push_back(rest_mv);
    thresholds.threshold_mv.push_back(threshold_mv);
    thresholds.reset_mv.push_back(static_cast<float>(parameters.value(kResetV, i) - rest_mv));
    thresholds.initial_mv.push_back(static_cast<float>(parameters.value(kInitialV, i) - rest_mv));
    thresholds.sleep_mv.push_back(threshold_mv > 0 ? threshold_mv * kSleepShare : -1.0F);
  }
  return thresholds;
}

}  // namespace

MembraneGroup::MembraneGroup(const SpikeImage& image, const GroupRecord& group)
    : constants_(derive_constants(image, group)),
      thresholds_(derive_thresholds(image, group)),
      u_(group.size),
      currents_(std::size_t{constants_.current_count} * group.size),
      refractory_(group.size),
      valid_after_(group.size),
      is_asleep_(group.size) {
  MembraneGroup::reset();
}

void MembraneGroup::reset() noexcept {
  for (std::uint32_t i = 0; i < constants_.size; ++i) {
    u_[i] = pick(thresholds_.initial_mv, i);
  }
  std::fill(currents_.begin(), currents_.end(), 0.0F);
  std::fill(refractory_.begin(), refractory_.end(), 0U);
  std::fill(valid_after_.begin(), valid_after_.end(), 0U);
  std::fill(is_asleep_.begin(), is_asleep_.end(), std::uint8_t{0});
}

MembraneGroup::State MembraneGroup::load(std::uint32_t neuron) const noexcept {
  State state{};
  state.u = u_[neuron];
  for (std::uint32_t c = 0; c < constants_.current_count; ++c) {
    state.currents[c] = currents_[std::size_t{c} * constants_.size + neuron];
  }
  return state;
}

void MembraneGroup::store(std::uint32_t neuron, const State& state) noexcept {
  u_[neuron] = state.u;
  for (std::uint32_t c = 0; c < constants_.current_count; ++c) {
    currents_[std::size_t{c} * constants_.size + neuron] = state.currents[c];
  }
}

void MembraneGroup::propagate(const float* entry, State& state) const noexcept {
  const std::uint32_t count = constants_.current_count;
  float u = entry[0] * without_dust(state.u);
  for (std::uint32_t c = 0; c < count; ++c) {
    const float current = without_dust(state.currents[c]);
    u += entry[1 + c] * current;
    state.currents[c] = entry[1 + count + c] * current;
  }
  state.u = u;
}

void MembraneGroup::leap(std::uint32_t ticks, State& state) const noexcept {
  const PropagatorTable layout{constants_.current_count};
  const float* level = constants_.levels.data();
  while (ticks != 0) {
    const std::uint32_t digit = ticks % PropagatorTable::kDigits;
    if (digit != 0) {
      propagate(level + std::size_t{digit} * layout.entry_size(), state);
    }
    level += std::size_t{PropagatorTable::kDigits} * layout.entry_size();
    ticks >>= PropagatorTable::kDigitBits;
  }
}

void MembraneGroup::add_inputs(std::uint32_t neuron, std::int32_t* inputs, State& state) const noexcept {
  for (std::uint32_t r = 0; r < constants_.receptor_count; ++r) {
    std::int32_t& input = inputs[std::size_t{r} * constants_.size + neuron];
    const auto quanta = static_cast<float>(input);
    input = 0;
    if (constants_.model == ModelKind::LifDelta) {
      state.u += constants_.delta_quantum_mv[r] * quanta;
    } else {
      state.currents[r] += quanta;
    }
  }
}

bool MembraneGroup::has_input(std::uint32_t neuron, const std::int32_t* inputs) const noexcept {
  std::int32_t any = 0;
  for (std::uint32_t r = 0; r < constants_.receptor_count; ++r) {
    any |= inputs[std::size_t{r} * constants_.size + neuron];
  }
  return any != 0;
}

// u(t + n) = A_n u + sum B_c,n J_c never exceeds max(u, 0) + sum max(M_c J_c, 0).
bool MembraneGroup::can_sleep(std::uint32_t neuron, const State& state) const noexcept {
  float bound_mv = std::max(state.u, 0.0F);
  for (std::uint32_t c = 0; c < constants_.current_count; ++c) {
    bound_mv += std::max(constants_.peak[c] * state.currents[c], 0.0F);
  }
  return bound_mv < pick(thresholds_.sleep_mv, neuron);
}

bool MembraneGroup::advance_neuron(std::uint32_t neuron, GroupTick& tick) noexcept {
  State state = load(neuron);
  const auto done = static_cast<std::uint32_t>(tick.tick + 1);  // ticks done once this one is
  if (is_asleep_[neuron] != 0) {
    leap(done - valid_after_[neuron], state);
  } else {
    propagate(constants_.step.data(), state);
  }
  add_inputs(neuron, tick.inputs, state);
  bool fires = false;
  if (refractory_[neuron] > 0) {
    --refractory_[neuron];
    state.u = pick(thresholds_.reset_mv, neuron);
  } else if (state.u >= pick(thresholds_.threshold_mv, neuron)) {
    fires = true;
    state.u = pick(thresholds_.reset_mv, neuron);
    refractory_[neuron] = constants_.refractory_ticks;
    if (constants_.model == ModelKind::Alif) {
      state.currents[constants_.current_count - 1] += constants_.adaptation_step_na;
    }
  }
  if (constants_.may_sleep) {
    is_asleep_[neuron] = static_cast<std::uint8_t>(refractory_[neuron] == 0 && can_sleep(neuron, state));
    valid_after_[neuron] = done;
  }
  store(neuron, state);
  return fires;
}

void MembraneGroup::advance(GroupTick& tick) noexcept {
  for (std::uint32_t i = 0; i < constants_.size; ++i) {
    if (is_asleep_[i] != 0 && !has_input(i, tick.inputs)) {
      continue;
    }
    if (advance_neuron(i, tick)) {
      tick.fire(i);
    }
  }
}

double MembraneGroup::probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept {
  State state = load(neuron);
  if (is_asleep_[neuron] != 0) {
    leap(static_cast<std::uint32_t>(tick) - valid_after_[neuron], state);
  }
  if (column == 0) {
    const std::vector<double>& rest_mv = thresholds_.rest_mv;
    return static_cast<double>(state.u) + (rest_mv.size() == 1 ? rest_mv[0] : rest_mv[neuron]);
  }
  // alif lists w before the receptors' currents, which it keeps last.
  std::uint32_t c = column - 1;
  if (constants_.model == ModelKind::Alif) {
    c = column == 1 ? constants_.current_count - 1 : column - 2;
  }
  return c < constants_.current_count ? static_cast<double>(state.currents[c]) * constants_.unit[c] : 0;
}

}  // namespace tectum
