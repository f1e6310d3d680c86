// Two circuits on the same input, tick by tick: where they first differ, population by population.
//
// The first has run already, with whatever its movements made of the world. The second is driven by the same pictures
// (tools/diff/open_loop_run.h), so that its movements change nothing. Then up to the first spike that differs both have
// the same history, and what makes that spike differ acts on that neuron itself. Two recordings can be compared in the
// same way; where their worlds differ, the first difference is one of fields.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/diff/neuron_account.h"
#include "tools/diff/structure_diff.h"

namespace tectum {

struct FirstSpike {
  std::uint32_t population = 0;  // of the second circuit
  std::uint64_t time_ns = 0;
  std::uint32_t neuron_a = 0, neuron_b = 0;
  bool fires_in_a = false;
  std::size_t neurons_at_once = 0;  // of this population at this time
};

struct FirstField {
  std::size_t frame = 0;
  std::uint64_t time_ns = 0;
  std::uint32_t neuron_a = kNoMatch, neuron_b = kNoMatch;  // kNoMatch where the circuit has no such field
  bool is_lit_in_a = false;
};

/// Of a joint: what the decoder says, or, while that is still the same, what the guard lets through.
struct FirstCommand {
  std::size_t joint = 0;
  std::uint64_t time_ns = 0;
  double a_deg = 0, b_deg = 0;
  bool is_decoded = false;
};

struct LockStep {
  std::vector<FirstSpike> spikes;  // one a population that comes to differ, ascending in time
  std::optional<FirstField> field;
  std::vector<FirstCommand> commands;  // one a joint, ascending in time
  double run_s = 0;                    // how far the comparison went
  [[nodiscard]] bool is_same() const { return spikes.empty() && !field && commands.empty(); }
};

/// Goes on for `follow_s` after the first difference, then stops. `produce_b`, where given, is called before each frame
/// of the second recording is looked at.
[[nodiscard]] LockStep lock_step(const CircuitView& a, const CircuitView& b, const Correspondence& match,
                                 const Recording& recording_a, const Recording& recording_b,
                                 const std::function<void(std::size_t frame)>& produce_b, double follow_s);

/// A neuron that no spike tells apart, but its potential does.
struct FirstPotential {
  std::uint32_t neuron_a = 0, neuron_b = 0;
  std::uint64_t time_ns = 0;
  double a = 0, b = 0;
};
/// Both circuits once more, with their potentials compared after each frame; nothing when those are the same too.
[[nodiscard]] std::optional<FirstPotential> first_potential(const CircuitView& a, const CircuitView& b,
                                                            const Correspondence& match, const Recording& recording_a,
                                                            const Recording& recording_b);

/// Of `neuron` of a in b, or kNoMatch.
[[nodiscard]] std::uint32_t counterpart(const CircuitView& a, const CircuitView& b, const Correspondence& match,
                                        std::uint32_t neuron);

}  // namespace tectum
