// The quantities of a projection's `plasticity`: what a circuit file calls them, defaults, ranges.
#pragma once

#include <array>

#include "compiler/expression/dimension.h"
#include "compiler/validate/circuit.h"

namespace tectum {

struct PlasticityNumber {
  const char* key;
  Dimension dimension;
  const char* default_text;  // nullptr: required
  double default_value;      // coherent
  double Plasticity::*field;
  const char* about;
};
inline constexpr std::array kPlasticityNumbers = {
    PlasticityNumber{"learning_rate", kFrequency, nullptr, 0, &Plasticity::learning_rate,
                     "eta: share of the declared weight that a second of M e = 1 adds"},
    PlasticityNumber{"tau_eligibility", kTime, "1 s", 1000, &Plasticity::tau_eligibility_ms,
                     "of the trace that waits for a reward"},
    PlasticityNumber{"tau_rate", kTime, "50 ms", 50, &Plasticity::tau_rate_ms, "of both neurons' rates"},
    PlasticityNumber{"tau_mean", kTime, "2 s", 2000, &Plasticity::tau_mean_ms, "of their mean rates"},
    PlasticityNumber{"tau_reward", kTime, "7 s", 7000, &Plasticity::tau_reward_ms, "of the reward's expectation"},
    PlasticityNumber{"reference_rate", kFrequency, "50 Hz", 0.05, &Plasticity::reference_rate,
                     "r0: deviations of both rates by this much make H = 1"},
};

/// Of each RewardChannel, for the manual.
inline constexpr std::array<const char*, kRewardChannelCount> kRewardChannelMeanings = {
    "horizontal, mean of the eyes that see the target",
    "vertical, mean of the eyes that see the target",
    "horizontal, left eye",
    "vertical, left eye",
    "horizontal, right eye",
    "vertical, right eye",
    "as `pan` while the target lies left of the middle, its negative while it lies right",
    "the negative of `leftward`",
    "as `tilt` while it lies above, its negative while it lies below",
    "the negative of `upward`",
};

}  // namespace tectum
