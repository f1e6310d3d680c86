// The neuron models that the engine runs: equation, parameters, state, source, known limits.
// The one table from which the compiler takes names, units and defaults, the dump its legends and
// the manual its reference page.
//
// What a group of neurons carries in the image, for every model:
//   parameters  [0, P)         the model's parameters in the order and unit of ModelInfo::parameters
//               [P, P + K)     tau_r of each of the K receptors, ms (0 unless Exponential)
//               [P + K, P + 2K) exp(-h / tau_r) over one tick h (0 unless Exponential)
//   columns     one for each parameter p whose bit kGroupColumnShift + p is set in the group's
//               flags, in ascending p; a column replaces the parameter neuron by neuron
//   tables      the membrane models' propagators, see PropagatorTable
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "runtime/image/spike_image.h"

namespace tectum {

/// Bit of GroupRecord::flags that says parameter 0 varies from neuron to neuron.
inline constexpr std::uint32_t kGroupColumnShift = 8;
inline constexpr std::uint32_t kMaxReceptors = 8;
inline constexpr std::uint32_t kMaxRefractoryTicks = 65535;
inline constexpr std::uint32_t kMaxDelayTicks = 1U << 20U;
inline constexpr std::uint32_t kMaxWindowTicks = 1U << 16U;
inline constexpr std::int32_t kMinQuantumLog2 = -80;
inline constexpr std::int32_t kMaxQuantumLog2 = 30;

struct ParameterInfo {
  std::string_view name;          // as in a circuit file
  std::string_view unit;          // "mV", "ms", "nA", "MOhm", "Hz", "mV/ms", "1/ms", or "" for a pure number
  double default_value;           // meaningless when default_text or is_required says otherwise
  std::string_view default_text;  // "E_L": the value of another parameter; "b * V_init"; else empty
  bool is_required;
  bool may_vary;  // one value a neuron is allowed
  double minimum;
  bool minimum_is_allowed;
  double maximum;
  std::string_view symbol;
  std::string_view meaning;
};

struct StateInfo {
  std::string_view name;
  std::string_view unit;
  std::string_view meaning;
};

struct ModelInfo {
  ModelKind kind;
  std::string_view name;  // as in a circuit file
  std::string_view title;
  std::string_view equation;
  std::string_view spike_condition;
  std::string_view reset;
  std::span<const ParameterInfo> parameters;
  std::span<const StateInfo> states;  // probe columns; one more a receptor follows (its current)
  std::string_view source;
  std::string_view limits;
  std::string_view weight_unit;  // of a synapse onto it; empty: takes no synapses
  std::uint32_t receptor_kinds;  // bit k: ReceptorKind k is allowed
  std::uint32_t min_receptors;
  std::uint32_t max_receptors;
  bool may_sleep;
};

/// All built-in models, in the order of ModelKind.
[[nodiscard]] std::span<const ModelInfo> all_models();
/// Null for a kind that is no built-in model.
[[nodiscard]] const ModelInfo* find_model(ModelKind kind);
[[nodiscard]] const ModelInfo* find_model(std::string_view name);
[[nodiscard]] std::optional<std::uint32_t> find_parameter(const ModelInfo& model, std::string_view name);
[[nodiscard]] std::string_view receptor_kind_name(ReceptorKind kind);
[[nodiscard]] std::string_view lit_channel_name(LitChannel channel);

// Parameter indices, in the order of each model's table in models.cpp.
namespace lif_parameter {  // lif_delta, lif_exp and alif share the first eight
enum : std::uint32_t { kTauM, kRestV, kThresholdV, kResetV, kRefractory, kResistance, kBias, kInitialV, kLifCount };
enum : std::uint32_t { kTauW = kLifCount, kAdaptationStep, kAlifCount };
}  // namespace lif_parameter
namespace izhikevich_parameter {
enum : std::uint32_t {
  kA,
  kB,
  kC,
  kD,
  kK2,
  kK1,
  kK0,
  kPeakV,
  kTimeScale,
  kRectify,
  kBias,
  kInitialV,
  kInitialU,
  kCount
};
}  // namespace izhikevich_parameter
namespace threshold_parameter {
enum : std::uint32_t { kTheta, kRefractory, kCount };
}  // namespace threshold_parameter
namespace source_parameter {  // poisson and field
enum : std::uint32_t { kRate, kCount };
}  // namespace source_parameter

/// Layout of a membrane group's part of the Tables section (f32). `C` is the number of currents:
/// the receptors, and for alif the adaptation current as the last one.
///
///   u(t + n h) = A_n u(t) + sum_c B_c,n I_c(t)      u = v - (E_L + R_m I_bias), mV
///   I_c(t + n h) = D_c,n I_c(t)                     nA (lif_delta has no current, C = 0)
///
/// One entry is A, B_0 .. B_{C-1}, D_0 .. D_{C-1}. The table is
///   the entry of n = 1, then the peak gains M_0 .. M_{C-1} = the B_c,n of largest size (mV/nA),
///   and for a group that may sleep the entries of n = d * 2^(b l) for each digit d of b bits and each
///   level l, so that any u32 number of ticks is a few entries applied one after the other, lowest
///   digit first. Large groups have wide digits (fewer steps), small ones a small table.
struct PropagatorTable {
  std::uint32_t current_count;
  std::uint32_t digit_bits;

  static constexpr std::uint32_t kLargeGroup = 4096;
  static constexpr PropagatorTable of(std::uint32_t current_count, std::uint32_t group_size) {
    return {current_count, group_size >= kLargeGroup ? 10U : 6U};
  }

  [[nodiscard]] constexpr std::uint32_t digits() const { return 1U << digit_bits; }
  /// Whole levels of all digits, and a last one that fills up the 32 bits.
  [[nodiscard]] constexpr std::uint32_t entry_count() const {
    return (32 / digit_bits) * digits() + (1U << (32 % digit_bits));
  }
  [[nodiscard]] constexpr std::uint32_t entry_size() const { return 1 + 2 * current_count; }
  [[nodiscard]] constexpr std::uint32_t peaks_begin() const { return entry_size(); }
  [[nodiscard]] constexpr std::uint32_t levels_begin() const { return entry_size() + current_count; }
  [[nodiscard]] constexpr std::uint32_t size(bool may_sleep) const {
    return levels_begin() + (may_sleep ? entry_count() * entry_size() : 0);
  }
};

/// Number of currents of a membrane group; 0 for other models.
[[nodiscard]] std::uint32_t current_count(ModelKind kind, std::uint32_t receptor_count);
/// Size of a group's part of the Tables section.
[[nodiscard]] std::uint32_t table_size(ModelKind kind, std::uint32_t receptor_count, std::uint32_t group_size,
                                       bool may_sleep);

}  // namespace tectum
