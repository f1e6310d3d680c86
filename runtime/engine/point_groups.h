// Izhikevich and threshold neurons, in double.
#pragma once

#include <vector>

#include "runtime/engine/receptor_inputs.h"
#include "runtime/engine/update_group.h"

namespace tectum {

/// dv/dt = s (k2 v^2 + k1 v + k0 - u + I), du/dt = s a (b v - u), forward Euler over one tick h:
///   v += (h s) (k2 (v v) + k1 v + k0 - u + I)     evaluated left to right
///   u += (h s) (a (b v - u))                      with the new v
///   v > V_peak  ->  spike, v = c, u += d
/// I is the sum of the receptors, then I_bias; with `rectify` a negative I counts as 0.
class IzhikevichGroup final : public UpdateGroup {
 public:
  IzhikevichGroup(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept override;
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;

 private:
  struct Neuron {
    double a, b, c, d, v_peak_mv, bias, initial_v_mv, initial_u;
  };
  [[nodiscard]] const Neuron& neuron(std::uint32_t i) const noexcept {
    return neurons_.size() == 1 ? neurons_[0] : neurons_[i];
  }

  std::uint32_t size_;
  double step_ms_, k2_, k1_, k0_;
  bool rectify_;
  std::vector<Neuron> neurons_;
  ReceptorInputs inputs_;
  std::vector<double> v_mv_;
  std::vector<double> u_;
};

/// Fires iff the summed input of its receptors reaches theta and it is not refractory.
class ThresholdGroup final : public UpdateGroup {
 public:
  ThresholdGroup(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept override;
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;

 private:
  std::uint32_t size_;
  std::uint32_t refractory_ticks_;
  std::vector<double> theta_;
  ReceptorInputs inputs_;
  std::vector<std::uint32_t> refractory_;
};

}  // namespace tectum
