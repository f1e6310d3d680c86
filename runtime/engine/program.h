// Runs an equation program over blocks of neurons: each step is one loop over a block.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/engine/spike_engine.h"
#include "runtime/image/program.h"

namespace tectum {

/// 64 doubles are 512 bytes: the places of a program of dozens of steps stay in the first-level cache.
inline constexpr std::size_t kProgramBlock = 64;

/// Arrays of one block. Each has kProgramBlock values, whatever the number of neurons in it.
struct ProgramBlock {
  std::span<double* const> states;
  std::span<const double* const> inputs;
  std::span<const double* const> columns;
  std::uint32_t* refractory;     // ticks left
  std::uint64_t* is_refractory;  // bit i: refractory[i] > 0
  std::size_t neuron_count;      // the values beyond are computed and ignored
};

class ProgramRunner {
 public:
  /// Needs: verified words. Copies what it needs. Not real-time safe: allocates.
  ProgramRunner(std::span<const std::uint32_t> words, std::span<const double> constants, SimdLevel simd);

  [[nodiscard]] const ProgramHeader& header() const noexcept { return header_; }
  /// The column or constant that state `s` starts from, for `neuron` of `columns`.
  [[nodiscard]] double initial_state(std::uint32_t s, std::span<const double> columns, std::size_t size,
                                     std::size_t neuron) const noexcept;

  /// One tick of one block. Bit i of the result: neuron i fired. Real-time safe.
  [[nodiscard]] std::uint64_t run(const ProgramBlock& block) noexcept;

 private:
  /// Runs the steps, then clears the dust of the first `dusty_states` states.
  using RunSteps = void (*)(std::span<const ProgramStep> steps, double* const* places,
                            std::size_t dusty_states) noexcept;

  void bind(const ProgramBlock& block) noexcept;
  void save_held(std::uint64_t neurons) noexcept;
  void restore_held(std::uint64_t neurons) noexcept;
  void reset_neurons(std::uint64_t neurons) noexcept;

  ProgramHeader header_;
  std::vector<std::uint32_t> initial_;
  std::vector<ProgramStep> update_;
  std::vector<ProgramStep> threshold_;
  std::vector<ProgramStep> reset_;
  std::vector<double> constants_;
  std::vector<double> blocks_;   // constants and temporaries, a block each
  std::vector<double> saved_;    // states before the update or the reset
  std::vector<double*> places_;  // operand → its block
  RunSteps run_steps_;
};

}  // namespace tectum
