// Leaky integrate-and-fire neurons: lif_delta, lif_exp and alif.
//
//   u = v - (E_L + R_m I_bias)        mV, so that rest is 0
//   J_c = I_c / quantum               currents in weight quanta (the adaptation current: nA)
//   u(t+h) = A u + sum_c G_c J_c      G_c = B_c * quantum
//   J_c(t+h) = D_c J_c, then += the quanta that arrived
//
// Everything is 32-bit float, left to right as written, without fused multiply-add, so that every
// kernel gives the same bits. Every 64th tick, and after each leap, a u or J smaller than 2^-63 becomes
// 0: subnormal numbers, which are slow, never last.
//
// Sleep, for a group with kGroupMaySleep. After a tick in which it was advanced, a neuron that is not
// refractory and has
//   max(u, 0) + sum_c max(M_c J_c, 0) < (1 - 2^-10) (V_th - rest),     V_th > rest,
// cannot reach threshold without input (M_c is the peak of what a unit current makes of u), and is asleep from then on.
// When its next input comes it leaps over the n ticks since with the propagators of n.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "runtime/engine/aligned_vector.h"
#include "runtime/engine/membrane_kernels.h"
#include "runtime/engine/update_group.h"

namespace tectum {

class MembraneGroup final : public UpdateGroup {
 public:
  MembraneGroup(const SpikeImage& image, const GroupRecord& group, const EngineOptions& options);

  void reset() noexcept override;
  void advance(GroupTick& tick) noexcept override;
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;
  [[nodiscard]] bool is_divisible() const noexcept override { return true; }
  [[nodiscard]] bool wants_marks() const noexcept override { return may_sleep_; }
  [[nodiscard]] std::vector<const void*> hot_arrays() const override;

 private:
  struct State {
    float u;
    float currents[kMaxReceptors + 1];
  };
  void derive_constants(const SpikeImage& image, const GroupRecord& group);
  void derive_thresholds(const SpikeImage& image, const GroupRecord& group);
  void derive_leaps(std::span<const float> table, const PropagatorTable& layout);

  [[nodiscard]] State load(std::uint32_t neuron) const noexcept;
  void propagate(const float* entry, State& state) const noexcept;
  void leap(std::uint32_t ticks, State& state) const noexcept;
  void remove_dust(State& state) const noexcept;
  /// A word of which many neurons are awake, as vectors.
  void sweep_awake(MembraneTick now, std::uint32_t word, GroupTick& tick) noexcept;
  /// Neurons picked one by one: all awake, or all asleep with input.
  void advance_picked(MembraneTick now, MembraneKernels::Picked kernel, std::span<const std::uint32_t> neurons,
                      GroupTick& tick) noexcept;
  void set_awake(std::uint32_t neuron, bool is_awake) noexcept;

  std::uint32_t size_;
  ModelKind model_;
  bool may_sleep_;
  bool has_own_thresholds_ = false;
  std::uint32_t dense_lanes_;  // a word with at least so many neurons awake is swept as a vector
  std::uint32_t digit_bits_ = 0;
  MembraneKernels kernels_;
  MembraneArgs args_{};
  std::vector<double> unit_;   // of each current: nA per J
  std::vector<float> step_;    // PropagatorTable entry of one tick, in units of J
  std::vector<float> levels_;  // the entries of the leaps, in units of J

  std::vector<double> rest_mv_;                                           // E_L + R_m I_bias, one or one a neuron
  AlignedVector<float> threshold_mv_, reset_mv_, sleep_mv_, initial_mv_;  // relative to rest

  AlignedVector<float> u_;
  AlignedVector<float> currents_;            // [current][padded]
  AlignedVector<std::uint16_t> refractory_;  // ticks left
  std::vector<std::uint64_t> awake_;         // bit a neuron
  std::vector<std::uint64_t> awake_words_;   // bit a word of awake_ that is not 0
  std::unique_ptr<std::uint32_t[]> picked_;  // room to list every neuron; left unwritten until used
  std::vector<std::uint32_t> valid_after_;   // asleep: the state is that after so many ticks (mod 2^32)
};

}  // namespace tectum
