// The inner loops of the membrane models, one set for each instruction set, all with the same bits.
//
// Included by translation units that are compiled for different instruction sets, so nothing here
// may be an inline function: the linker would keep one copy of it for all.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/engine/spike_engine.h"
#include "runtime/image/models.h"

namespace tectum {

/// Arrays are indexed by neuron and padded to whole words of 64 neurons.
struct MembraneArgs {
  // State. See membrane_group.h for the equations.
  float* u;
  float* currents;            // [current][stride]
  std::uint16_t* refractory;  // ticks left
  std::size_t stride;
  // Thresholds, relative to rest: one a neuron, or null where the shared ones hold.
  const float* threshold_mv;
  const float* reset_mv;
  const float* sleep_mv;
  float shared_threshold_mv;
  float shared_reset_mv;
  float shared_sleep_mv;
  // Constants.
  float decay;
  float gain[kMaxReceptors + 1];
  float current_decay[kMaxReceptors + 1];
  float peak[kMaxReceptors + 1];
  float delta_quantum_mv[kMaxReceptors];
  float adaptation_step_na;
  std::uint32_t refractory_ticks;
  std::uint32_t receptor_count;
  std::uint32_t current_count;
  std::size_t input_stride;
  std::uint32_t size;  // neurons of the group
};

struct MembraneTick {
  std::int32_t* inputs;  // [receptor][MembraneArgs::input_stride], not padded; what is read is zeroed
  bool removes_dust;     // every 64th tick a u or J below 2^-63 becomes 0 first
};

struct MembraneWord {
  std::uint64_t fired;      // bit i: neuron 64 w + i
  std::uint64_t may_sleep;  // of the lanes that were advanced
};

/// The propagators of many ticks; see PropagatorTable.
struct MembraneLeaps {
  const float* levels;
  std::uint32_t digit_bits;
  std::uint32_t* valid_after;  // [neuron] asleep: its state is that after so many ticks (mod 2^32)
};

struct MembraneKernels {
  /// Advances neurons [begin, end) by one tick, appends who fired to `fired` and returns how many.
  /// Needs: begin a multiple of 64; end a multiple of 64 or the size.
  using Sweep = std::uint32_t (*)(const MembraneArgs& args, MembraneTick tick, std::uint32_t begin, std::uint32_t end,
                                  std::uint32_t* fired) noexcept;
  /// Advances the neurons of word w (64 w to 64 w + 63) whose bit is set in `lanes`; the others keep
  /// their state and their inputs. Needs: none of the others refractory.
  using SweepWord = MembraneWord (*)(const MembraneArgs& args, MembraneTick tick, std::uint32_t w,
                                     std::uint64_t lanes) noexcept;
  /// Advances `count` <= 64 neurons picked by index by one tick, or brings them, asleep, from where
  /// they fell asleep through this tick, after which `done` ticks are done. Bit k: neurons[k].
  using Picked = MembraneWord (*)(const MembraneArgs& args, MembraneTick tick, const MembraneLeaps& leaps,
                                  const std::uint32_t* neurons, std::uint32_t count, std::uint32_t done) noexcept;
  Sweep sweep;
  SweepWord sweep_word;
  Picked leap;
  Picked step;
};

/// The kernels for a model with so many currents, with thresholds that are shared or not.
[[nodiscard]] MembraneKernels membrane_kernels(SimdLevel level, ModelKind model, std::uint32_t current_count,
                                               bool has_own_thresholds);

// One set each; membrane_kernels() picks. The last two need a processor that has the instructions.
[[nodiscard]] MembraneKernels portable_membrane_kernels(ModelKind, std::uint32_t current_count, bool own);
[[nodiscard]] MembraneKernels avx2_membrane_kernels(ModelKind, std::uint32_t current_count, bool own);
[[nodiscard]] MembraneKernels avx512_membrane_kernels(ModelKind, std::uint32_t current_count, bool own);

}  // namespace tectum
