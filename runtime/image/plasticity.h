// Synapses that learn: what the three sections of an image that learns hold.
//
// The rule, once for each reward sample, T seconds after the last one; pre neuron j, post neuron i:
//
//   r     <- r + g_rate (n / T - r)                n: spikes since the last sample; rate, Hz
//   rbar  <- rbar + g_mean (r - rbar)              g = max(1 - a, 1 / samples so far), for r and rbar
//   H     =  (r_i - rbar_i) (r_j - rbar_j) / r0^2  covariance term (Sejnowski 1977, J Math Biol 4:303)
//   e     <- a_elig e + (1 - a_elig) H             eligibility
//   Rbar  <- Rbar + g_reward (R - Rbar)            expectation of the reward; g_reward likewise, samples of R
//   M     =  R - Rbar
//   s     <- clip(s + eta T F, lowest, highest)    F = M e, M H e or (1 - M) H e by PlasticityForm
//   w     =  base s
//
// (Fremaux & Gerstner 2016, doi:10.3389/fncir.2015.00085; Balachandar & Michmizos 2020, arXiv:2002.07534.)
// With a = exp(-T / tau), taken as the product of the powers below over the binary digits of T in ticks. The first
// sample makes each mean the sample itself. A step without a sample of the rule's own channel moves traces and changes
// no weight. s is whole numbers of 2^-28, w whole quanta of its receptor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tectum {

enum class PlasticityForm : std::uint32_t {
  ThreeFactor = 0,  // M e
  SeedEq2 = 1,      // M H e, Eq. 2 of the paper read literally
  SeedCode = 2,     // (1 - M) H e, what its authors' program does
};
inline constexpr std::array<const char*, 3> kPlasticityFormNames = {"three_factor", "seed_eq2", "seed_code"};

/// R = 1 - |x|, x the target's place on the retina from the centre (0) to the edge (1); runtime/learn/retinal_reward.h.
enum class RewardChannel : std::uint32_t {
  Pan,
  Tilt,
  LeftEyePan,
  LeftEyeTilt,
  RightEyePan,
  RightEyeTilt,
  Leftward,
  Rightward,
  Upward,
  Downward,
};
inline constexpr std::uint32_t kRewardChannelCount = 10;
inline constexpr std::array<const char*, kRewardChannelCount> kRewardChannelNames = {
    "pan",      "tilt",      "left_eye_pan", "left_eye_tilt", "right_eye_pan", "right_eye_tilt",
    "leftward", "rightward", "upward",       "downward"};

/// Factors s are whole numbers of 2^-kScaleBits.
inline constexpr int kScaleBits = 28;
inline constexpr std::int32_t kScaleOne = std::int32_t{1} << kScaleBits;
/// Powers exp(-h 2^k / tau), k = 0 .. kDecayPowers - 1, of one time constant in the Decays section; h is the tick.
inline constexpr std::uint32_t kDecayPowers = 32;
/// Time constants of a rule, in this order in the Decays section: rate, mean rate, eligibility, expected reward.
inline constexpr std::uint32_t kDecaysOfRule = 4;

/// How one pathway (a projection between two population sides) learns.
struct PlasticityRecord {
  std::uint32_t projection;  // index into Projections: names the populations and the receptor
  PlasticityForm form;
  RewardChannel channel;
  std::uint32_t first_synapse;  // into PlasticSynapses
  std::uint32_t synapse_count;
  std::uint32_t listed_count;  // synapses that the circuit declares, before lesions; ordinals are below
  std::uint32_t first_decay;   // into Decays: kDecaysOfRule * kDecayPowers values
  std::uint32_t reserved;
  double learning_rate_hz;   // eta
  double reference_rate_hz;  // r0
  std::int32_t lowest;       // of s, in 2^-28
  std::int32_t highest;
};
static_assert(sizeof(PlasticityRecord) == 56);

/// In the order of presynaptic neurons, then of targets.
struct PlasticSynapseRecord {
  std::uint32_t target;      // index into Targets
  std::uint32_t pre;         // in its population
  std::uint32_t post;        // in its population
  std::uint32_t ordinal;     // among the pathway's synapses as declared
  std::int32_t base_quanta;  // of the declared weight
  std::int32_t scale;        // s at the start, in 2^-28
};
static_assert(sizeof(PlasticSynapseRecord) == 24);

/// base * scale, rounded half up.
[[nodiscard]] constexpr std::int32_t plastic_quanta(std::int32_t base_quanta, std::int32_t scale) {
  const std::int64_t product = std::int64_t{base_quanta} * scale;
  return static_cast<std::int32_t>((product + (std::int64_t{1} << (kScaleBits - 1))) >> kScaleBits);
}

}  // namespace tectum
