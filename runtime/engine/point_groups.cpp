#include "runtime/engine/point_groups.h"

#include <algorithm>

namespace tectum {

IzhikevichGroup::IzhikevichGroup(const SpikeImage& image, const GroupRecord& group)
    : size_(group.size), inputs_(image, group), v_mv_(group.size), u_(group.size) {
  using namespace izhikevich_parameter;
  const GroupParameters parameters(image, group);
  step_ms_ = parameters.tick_ms() * parameters.value(kTimeScale);
  k2_ = parameters.value(kK2);
  k1_ = parameters.value(kK1);
  k0_ = parameters.value(kK0);
  rectify_ = parameters.value(kRectify) != 0;
  bool varies = false;
  for (const std::uint32_t p : {kA, kB, kC, kD, kPeakV, kBias, kInitialV, kInitialU}) {
    varies = varies || parameters.varies(p);
  }
  for (std::uint32_t i = 0; i < (varies ? size_ : 1); ++i) {
    neurons_.push_back({parameters.value(kA, i), parameters.value(kB, i), parameters.value(kC, i),
                        parameters.value(kD, i), parameters.value(kPeakV, i), parameters.value(kBias, i),
                        parameters.value(kInitialV, i), parameters.value(kInitialU, i)});
  }
  IzhikevichGroup::reset();
}

void IzhikevichGroup::reset() noexcept {
  for (std::uint32_t i = 0; i < size_; ++i) {
    v_mv_[i] = neuron(i).initial_v_mv;
    u_[i] = neuron(i).initial_u;
  }
  inputs_.reset();
}

void IzhikevichGroup::advance(GroupTick& tick) noexcept {
  inputs_.advance(tick.tick, tick.inputs);
  for (std::uint32_t i = 0; i < size_; ++i) {
    const Neuron& p = neuron(i);
    double input = inputs_.sum(i) + p.bias;
    if (rectify_ && input < 0) {
      input = 0;
    }
    double v = v_mv_[i];
    double u = u_[i];
    v = v + step_ms_ * (k2_ * (v * v) + k1_ * v + k0_ - u + input);
    u = u + step_ms_ * (p.a * (p.b * v - u));
    if (v > p.v_peak_mv) {
      v = p.c;
      u = u + p.d;
      tick.fire(i);
    }
    v_mv_[i] = v;
    u_[i] = u;
  }
}

double IzhikevichGroup::probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t) const noexcept {
  switch (column) {
    case 0:
      return v_mv_[neuron];
    case 1:
      return u_[neuron];
    default:
      return column - 2 < inputs_.receptor_count() ? inputs_.value(column - 2, neuron) : 0;
  }
}

ThresholdGroup::ThresholdGroup(const SpikeImage& image, const GroupRecord& group)
    : size_(group.size), inputs_(image, group), refractory_(group.size) {
  const GroupParameters parameters(image, group);
  refractory_ticks_ = parameters.ticks(threshold_parameter::kRefractory);
  for (std::uint32_t i = 0; i < size_; ++i) {
    theta_.push_back(parameters.value(threshold_parameter::kTheta, i));
  }
}

void ThresholdGroup::reset() noexcept {
  inputs_.reset();
  std::fill(refractory_.begin(), refractory_.end(), 0U);
}

void ThresholdGroup::advance(GroupTick& tick) noexcept {
  inputs_.advance(tick.tick, tick.inputs);
  for (std::uint32_t i = 0; i < size_; ++i) {
    if (refractory_[i] > 0) {
      --refractory_[i];
    } else if (inputs_.sum(i) >= theta_[i]) {
      refractory_[i] = refractory_ticks_;
      tick.fire(i);
    }
  }
}

double ThresholdGroup::probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t) const noexcept {
  if (column == 0) {
    return inputs_.sum(neuron);
  }
  return column - 1 < inputs_.receptor_count() ? inputs_.value(column - 1, neuron) : 0;
}

}  // namespace tectum
