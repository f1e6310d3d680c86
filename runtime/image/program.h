// Equation programs: what a neuron model that is declared by its equations computes each tick.
//
// A Program group's words lie at [data_begin, data_begin + data_count) of the Programs section.
// Its other arrays are laid out as follows (P constants, C columns, K receptors):
//   parameters  [0, P)            the program's constants, in its own units
//               [P, P + K)        tau_r of each receptor, ms (0 unless Exponential)
//               [P + K, P + 2K)   exp(-h / tau_r) over one tick h (0 unless Exponential)
//   columns     C columns, one value a neuron each; GroupRecord::flags carries no column mask
//
// Words: the ProgramHeader, then S operands with the initial states, then the steps of five words
// each: update, threshold, reset.
//
// Operands number the places a step reads, and the first S and the last T also those it may write:
//   [0, S)              states
//   [S, S + K)          inputs: what each receptor's kind makes of the arrivals, in this tick
//   next C              columns
//   next P              constants
//   next T              temporaries
//
// One tick of one neuron:
//   1. the update steps run
//   2. states whose bit is set in hold_mask take their old value back while the neuron is refractory
//   3. a refractory neuron counts down; any other fires when the threshold steps leave something
//      other than 0 in `fires`, and then the reset steps run and it is refractory for refractory_ticks
//   4. states smaller than kSmallestState become 0, so that subnormal numbers do not linger
// Every step is IEEE double arithmetic without fused multiply-add, and the functions are our own
// (runtime/engine/portable_math.h), so that every machine gives the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tectum {

inline constexpr std::uint32_t kProgramVersion = 1;
inline constexpr std::uint32_t kMaxProgramStates = 32;  // hold_mask has a bit for each
inline constexpr double kSmallestState = 0x1p-500;

enum class ProgramOp : std::uint32_t {
  Copy = 1,  // target = a
  Negate,
  Not,  // truth values are 0 and 1; anything but 0 is true
  Add,
  Subtract,
  Multiply,
  Divide,
  MultiplyAdd,  // a * b, rounded, + c
  Power,
  Equal,
  NotEqual,
  Less,
  LessEqual,
  And,
  Or,
  Select,  // a ? b : c
  Exp,
  ExpRatio,  // (e^a - 1) / a, 1 for a = 0
  Log,
  Log2,
  Log10,
  Sqrt,
  Abs,
  Floor,
  Ceil,
  Sign,
  Sin,  // angles in radians
  Cos,
  Tan,
  Asin,
  Acos,
  Atan,
  Tanh,
  Min,
  Max,
  Atan2,
  Hypot,
  Mod,  // a - b floor(a / b)
};
inline constexpr std::uint32_t kProgramOpCount = static_cast<std::uint32_t>(ProgramOp::Mod);

struct ProgramHeader {
  std::uint32_t version;
  std::uint32_t state_count;
  std::uint32_t input_count;
  std::uint32_t column_count;
  std::uint32_t constant_count;
  std::uint32_t temporary_count;
  std::uint32_t update_count;     // steps
  std::uint32_t threshold_count;  // steps
  std::uint32_t reset_count;      // steps
  std::uint32_t fires;            // operand
  std::uint32_t refractory_ticks;
  std::uint32_t hold_mask;  // bit s: state s holds while refractory
};
inline constexpr std::size_t kProgramHeaderWords = sizeof(ProgramHeader) / sizeof(std::uint32_t);
static_assert(kProgramHeaderWords == 12);

/// Unused operands are 0.
struct ProgramStep {
  ProgramOp op;
  std::uint32_t target;
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t c;
};
inline constexpr std::size_t kProgramStepWords = sizeof(ProgramStep) / sizeof(std::uint32_t);
static_assert(kProgramStepWords == 5);

/// Number of operands that `op` reads, 0 for no operation.
[[nodiscard]] std::uint32_t operand_count(ProgramOp op);
/// "multiply_add", for the dump; "unknown" for no operation.
[[nodiscard]] const char* program_op_name(ProgramOp op);

/// True when the words are one whole program whose every operand exists, is written where it may be
/// and before it is read. Otherwise `why` says what is wrong. The caller compares the counts in the
/// header with those of the group.
[[nodiscard]] bool verify_program(std::span<const std::uint32_t> words, std::string& why);

/// What each word means, for the dump. Needs: verified words.
[[nodiscard]] std::vector<std::string> describe_program(std::span<const std::uint32_t> words);

/// Needs: verified words.
[[nodiscard]] ProgramHeader program_header(std::span<const std::uint32_t> words);
/// Step `index` of all steps in order: update, threshold, reset.
[[nodiscard]] ProgramStep program_step(std::span<const std::uint32_t> words, std::size_t index);

}  // namespace tectum
