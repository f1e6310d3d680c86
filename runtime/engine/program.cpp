// Comparisons of NaN raise no trap here. Told so, g++ turns selections into vector code; no result changes.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-trapping-math")
#endif

#include "runtime/engine/program.h"

#include <algorithm>
#include <array>
#include <bit>

#include "runtime/engine/portable_math.h"

#if defined(__GNUC__) && !defined(__clang__)
#define TECTUM_INDEPENDENT_LOOP _Pragma("GCC ivdep")
#else
#define TECTUM_INDEPENDENT_LOOP
#endif

namespace tectum {
namespace {

// A target is either the same block as an operand or apart from it, so the iterations are independent.
template <typename Function>
[[gnu::always_inline]] inline void each(double* target, const double* a, Function f) noexcept {
  TECTUM_INDEPENDENT_LOOP
  for (std::size_t i = 0; i < kProgramBlock; ++i) {
    target[i] = f(a[i]);
  }
}
template <typename Function>
[[gnu::always_inline]] inline void each(double* target, const double* a, const double* b, Function f) noexcept {
  TECTUM_INDEPENDENT_LOOP
  for (std::size_t i = 0; i < kProgramBlock; ++i) {
    target[i] = f(a[i], b[i]);
  }
}
template <typename Function>
[[gnu::always_inline]] inline void each(double* target, const double* a, const double* b, const double* c,
                                        Function f) noexcept {
  TECTUM_INDEPENDENT_LOOP
  for (std::size_t i = 0; i < kProgramBlock; ++i) {
    target[i] = f(a[i], b[i], c[i]);
  }
}

double truth(bool value) noexcept { return value ? 1.0 : 0.0; }

// The functions that are too long to be worth a loop of vector code.
void run_scalar_step(ProgramOp op, double* t, const double* a, const double* b) noexcept {
  switch (op) {
    case ProgramOp::Power:
      return each(t, a, b, [](double x, double y) { return portable::power(x, y); });
    case ProgramOp::Log2:
      return each(t, a, [](double x) { return portable::log2(x); });
    case ProgramOp::Log10:
      return each(t, a, [](double x) { return portable::log10(x); });
    case ProgramOp::Sin:
      return each(t, a, [](double x) { return portable::sin(x); });
    case ProgramOp::Cos:
      return each(t, a, [](double x) { return portable::cos(x); });
    case ProgramOp::Tan:
      return each(t, a, [](double x) { return portable::tan(x); });
    case ProgramOp::Asin:
      return each(t, a, [](double x) { return portable::asin(x); });
    case ProgramOp::Acos:
      return each(t, a, [](double x) { return portable::acos(x); });
    case ProgramOp::Atan:
      return each(t, a, [](double x) { return portable::atan(x); });
    case ProgramOp::Tanh:
      return each(t, a, [](double x) { return portable::tanh(x); });
    case ProgramOp::Atan2:
      return each(t, a, b, [](double x, double y) { return portable::atan2(x, y); });
    case ProgramOp::Hypot:
      return each(t, a, b, [](double x, double y) { return portable::hypot(x, y); });
    case ProgramOp::Mod:
      return each(t, a, b, [](double x, double y) { return portable::mod(x, y); });
    case ProgramOp::Floor:
      return each(t, a, [](double x) { return std::floor(x); });
    case ProgramOp::Ceil:
      return each(t, a, [](double x) { return std::ceil(x); });
    default:
      return;
  }
}

[[gnu::always_inline]] inline void run_step(const ProgramStep& step, double* const* places) noexcept {
  double* const t = places[step.target];
  const double* const a = places[step.a];
  const double* const b = places[step.b];
  const double* const c = places[step.c];
  switch (step.op) {
    case ProgramOp::Copy:
      return each(t, a, [](double x) { return x; });
    case ProgramOp::Negate:
      return each(t, a, [](double x) { return -x; });
    case ProgramOp::Not:
      return each(t, a, [](double x) { return truth(x == 0); });
    case ProgramOp::Add:
      return each(t, a, b, [](double x, double y) { return x + y; });
    case ProgramOp::Subtract:
      return each(t, a, b, [](double x, double y) { return x - y; });
    case ProgramOp::Multiply:
      return each(t, a, b, [](double x, double y) { return x * y; });
    case ProgramOp::Divide:
      return each(t, a, b, [](double x, double y) { return x / y; });
    case ProgramOp::MultiplyAdd:
      return each(t, a, b, c, [](double x, double y, double z) { return x * y + z; });
    case ProgramOp::Equal:
      return each(t, a, b, [](double x, double y) { return truth(x == y); });
    case ProgramOp::NotEqual:
      return each(t, a, b, [](double x, double y) { return truth(x != y); });
    case ProgramOp::Less:
      return each(t, a, b, [](double x, double y) { return truth(x < y); });
    case ProgramOp::LessEqual:
      return each(t, a, b, [](double x, double y) { return truth(x <= y); });
    case ProgramOp::And:
      return each(t, a, b, [](double x, double y) { return truth((x != 0) & (y != 0)); });
    case ProgramOp::Or:
      return each(t, a, b, [](double x, double y) { return truth((x != 0) | (y != 0)); });
    case ProgramOp::Select:
      return each(t, a, b, c, [](double x, double y, double z) { return x != 0 ? y : z; });
    case ProgramOp::Exp:
      return each(t, a, [](double x) { return portable::exp(x); });
    case ProgramOp::ExpRatio:
      return each(t, a, [](double x) { return portable::exp_ratio(x); });
    case ProgramOp::Log:
      return each(t, a, [](double x) { return portable::log(x); });
    case ProgramOp::Sqrt:
      return each(t, a, [](double x) { return std::sqrt(x); });
    case ProgramOp::Abs:
      return each(t, a, [](double x) { return std::abs(x); });
    case ProgramOp::Sign:
      return each(t, a, [](double x) { return portable::sign(x); });
    case ProgramOp::Min:
      return each(t, a, b, [](double x, double y) { return y < x ? y : x; });
    case ProgramOp::Max:
      return each(t, a, b, [](double x, double y) { return x < y ? y : x; });
    default:
      return run_scalar_step(step.op, t, a, b);
  }
}

// Bit i: values[i] is not 0. Most blocks have no spike, which one loop of vector code tells.
std::uint64_t nonzero(const double* values) noexcept {
  std::array<std::uint64_t, 8> any{};
  for (std::size_t i = 0; i < kProgramBlock; i += any.size()) {
    for (std::size_t lane = 0; lane < any.size(); ++lane) {
      any[lane] |= std::bit_cast<std::uint64_t>(values[i + lane]);
    }
  }
  if ((any[0] | any[1] | any[2] | any[3] | any[4] | any[5] | any[6] | any[7]) == 0) {
    return 0;
  }
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < kProgramBlock; ++i) {
    bits |= std::uint64_t{values[i] != 0} << i;
  }
  return bits;
}

// The same code for three instruction sets: the arithmetic is IEEE, so the bits are the same.
[[gnu::always_inline]] inline void run_all(std::span<const ProgramStep> steps, double* const* places,
                                           std::size_t dusty_states) noexcept {
  for (const ProgramStep& step : steps) {
    run_step(step, places);
  }
  for (std::size_t s = 0; s < dusty_states; ++s) {
    each(places[s], places[s], [](double x) { return std::abs(x) < kSmallestState ? 0.0 : x; });
  }
}

void run_steps_portable(std::span<const ProgramStep> steps, double* const* places, std::size_t dusty_states) noexcept {
  run_all(steps, places, dusty_states);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void run_steps_avx2(std::span<const ProgramStep> steps, double* const* places,
                                            std::size_t dusty_states) noexcept {
  run_all(steps, places, dusty_states);
}
[[gnu::target("avx512f,avx512dq,avx512vl")]] void run_steps_avx512(std::span<const ProgramStep> steps,
                                                                   double* const* places,
                                                                   std::size_t dusty_states) noexcept {
  run_all(steps, places, dusty_states);
}
#endif

}  // namespace

ProgramRunner::ProgramRunner(std::span<const std::uint32_t> words, std::span<const double> constants, SimdLevel simd)
    : header_(program_header(words)),
      initial_(words.begin() + kProgramHeaderWords, words.begin() + kProgramHeaderWords + header_.state_count),
      constants_(constants.begin(), constants.begin() + header_.constant_count),
      blocks_((std::size_t{header_.constant_count} + header_.temporary_count) * kProgramBlock),
      saved_(header_.state_count * kProgramBlock),
      run_steps_(run_steps_portable) {
  std::size_t next = 0;
  const auto read_steps = [&](std::uint32_t count, std::vector<ProgramStep>& steps) {
    for (std::uint32_t k = 0; k < count; ++k) {
      steps.push_back(program_step(words, next++));
    }
  };
  read_steps(header_.update_count, update_);
  read_steps(header_.threshold_count, threshold_);
  read_steps(header_.reset_count, reset_);
  places_.resize(std::size_t{header_.state_count} + header_.input_count + header_.column_count);
  for (std::size_t k = 0; k < blocks_.size() / kProgramBlock; ++k) {
    double* const block = blocks_.data() + k * kProgramBlock;
    std::fill_n(block, kProgramBlock, k < constants_.size() ? constants_[k] : 0.0);
    places_.push_back(block);
  }
#if defined(__x86_64__)
  const bool any = simd == SimdLevel::Automatic;
  if ((any || simd == SimdLevel::Avx2 || simd == SimdLevel::Avx512) && __builtin_cpu_supports("avx2")) {
    run_steps_ = run_steps_avx2;
  }
  const bool has_avx512 =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if ((any || simd == SimdLevel::Avx512) && has_avx512) {
    run_steps_ = run_steps_avx512;
  }
#else
  static_cast<void>(simd);
#endif
}

double ProgramRunner::initial_state(std::uint32_t s, std::span<const double> columns, std::size_t size,
                                    std::size_t neuron) const noexcept {
  const std::size_t first_column = std::size_t{header_.state_count} + header_.input_count;
  const std::size_t first_constant = first_column + header_.column_count;
  const std::size_t operand = initial_[s];
  return operand < first_constant ? columns[(operand - first_column) * size + neuron]
                                  : constants_[operand - first_constant];
}

void ProgramRunner::bind(const ProgramBlock& block) noexcept {
  std::size_t next = 0;
  for (double* const state : block.states) {
    places_[next++] = state;
  }
  // Steps write only states and temporaries, which verify_program has checked.
  for (const double* const input : block.inputs) {
    places_[next++] = const_cast<double*>(input);
  }
  for (const double* const column : block.columns) {
    places_[next++] = const_cast<double*>(column);
  }
}

void ProgramRunner::save_held(std::uint64_t neurons) noexcept {
  for (std::uint32_t held = header_.hold_mask; held != 0; held &= held - 1) {
    const auto s = static_cast<std::size_t>(std::countr_zero(held));
    for (std::uint64_t left = neurons; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      saved_[s * kProgramBlock + static_cast<std::size_t>(i)] = places_[s][i];
    }
  }
}

void ProgramRunner::restore_held(std::uint64_t neurons) noexcept {
  for (std::uint32_t held = header_.hold_mask; held != 0; held &= held - 1) {
    const auto s = static_cast<std::size_t>(std::countr_zero(held));
    for (std::uint64_t left = neurons; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      places_[s][i] = saved_[s * kProgramBlock + static_cast<std::size_t>(i)];
    }
  }
}

void ProgramRunner::reset_neurons(std::uint64_t neurons) noexcept {
  for (std::size_t s = 0; s < header_.state_count; ++s) {
    std::copy_n(places_[s], kProgramBlock, saved_.data() + s * kProgramBlock);
  }
  // The whole block is reset, and then all but these neurons get their old values back.
  run_steps_(reset_, places_.data(), 0);
  for (std::size_t s = 0; s < header_.state_count; ++s) {
    double* const saved = saved_.data() + s * kProgramBlock;
    for (std::uint64_t left = neurons; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      saved[i] = places_[s][i];
    }
    std::copy_n(saved, kProgramBlock, places_[s]);
  }
}

std::uint64_t ProgramRunner::run(const ProgramBlock& block) noexcept {
  static_assert(kProgramBlock == 64, "one bit a neuron");
  bind(block);
  const std::uint64_t refractory = *block.is_refractory;
  save_held(refractory);
  run_steps_(update_, places_.data(), 0);
  restore_held(refractory);
  run_steps_(threshold_, places_.data(), 0);
  std::uint64_t fired = nonzero(places_[header_.fires]) & ~refractory;
  for (std::uint64_t left = refractory; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    if (--block.refractory[i] == 0) {
      *block.is_refractory &= ~(std::uint64_t{1} << i);
    }
  }
  fired &= block.neuron_count == kProgramBlock ? ~std::uint64_t{0} : (std::uint64_t{1} << block.neuron_count) - 1;
  if (fired != 0) {
    reset_neurons(fired);
    for (std::uint64_t left = fired; left != 0; left &= left - 1) {
      block.refractory[std::countr_zero(left)] = header_.refractory_ticks;
    }
    *block.is_refractory |= header_.refractory_ticks > 0 ? fired : 0;
  }
  run_steps_({}, places_.data(), header_.state_count);
  return fired;
}

}  // namespace tectum
