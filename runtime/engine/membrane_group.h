// Leaky integrate-and-fire neurons: lif_delta, lif_exp and alif.
//
//   u = v - (E_L + R_m I_bias)        mV, so that rest is 0
//   J_c = I_c / quantum               currents in weight quanta (the adaptation current: nA)
//   u(t+h) = A u + sum_c G_c J_c      G_c = B_c * quantum
//   J_c(t+h) = D_c J_c, then += the quanta that arrived
//
// Everything is 32-bit float, left to right as written, without fused multiply-add, so that every
// kernel gives the same bits. A u or J smaller than 2^-63 counts as 0: subnormal numbers never occur.
#pragma once

#include <vector>

#include "runtime/engine/update_group.h"
#include "runtime/image/models.h"

namespace tectum {

/// Constants of a group, derived once at load.
struct MembraneConstants {
  ModelKind model = ModelKind::LifExp;
  std::uint32_t size = 0;
  std::uint32_t receptor_count = 0;
  std::uint32_t current_count = 0;
  std::uint32_t refractory_ticks = 0;
  bool may_sleep = false;
  std::vector<float> delta_quantum_mv;  // lif_delta: mV a quantum, by receptor
  float adaptation_step_na = 0;         // alif
  std::vector<double> unit;             // of each current: nA per J
  std::vector<float> step;              // entry of one tick, in units of J
  std::vector<float> peak;              // M_c, mV per J
  std::vector<float> levels;            // PropagatorTable entries, in units of J
};

/// Values that may differ from neuron to neuron; each vector has one element or one a neuron.
struct MembraneThresholds {
  std::vector<double> rest_mv;      // E_L + R_m I_bias
  std::vector<float> threshold_mv;  // relative to rest
  std::vector<float> reset_mv;      // relative to rest
  std::vector<float> sleep_mv;      // a bound on all that is to come below this: asleep
  std::vector<float> initial_mv;    // relative to rest
};

class MembraneGroup final : public UpdateGroup {
 public:
  MembraneGroup(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept override;
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;

 private:
  struct State {
    float u;
    float currents[kMaxReceptors + 1];
  };
  [[nodiscard]] State load(std::uint32_t neuron) const noexcept;
  void store(std::uint32_t neuron, const State& state) noexcept;
  void propagate(const float* entry, State& state) const noexcept;
  void leap(std::uint32_t ticks, State& state) const noexcept;
  void add_inputs(std::uint32_t neuron, std::int32_t* inputs, State& state) const noexcept;
  [[nodiscard]] bool has_input(std::uint32_t neuron, const std::int32_t* inputs) const noexcept;
  [[nodiscard]] bool can_sleep(std::uint32_t neuron, const State& state) const noexcept;
  [[nodiscard]] bool advance_neuron(std::uint32_t neuron, GroupTick& tick) noexcept;

  MembraneConstants constants_;
  MembraneThresholds thresholds_;
  std::vector<float> u_;                    // [neuron]
  std::vector<float> currents_;             // [current][neuron]
  std::vector<std::uint32_t> refractory_;   // ticks left
  std::vector<std::uint32_t> valid_after_;  // asleep: the state is that after so many ticks (mod 2^32)
  std::vector<std::uint8_t> is_asleep_;
};

}  // namespace tectum
