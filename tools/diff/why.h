// Why a recorded movement or spike happened: which spikes, through which projections, made it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/diff/neuron_account.h"

namespace tectum {

struct RecordedCircuit {
  const Recording& recording;
  const CircuitView& view;
};

/// What one pathway brought to one neuron.
struct NeuronShare {
  std::string projection, where;  // "ifn_llbn", "IFN.left -> LLBN.left"
  std::string unit;               // of the input
  InputShare share;
  std::size_t recent_spikes = 0;            // that arrived within kRecentMs
  std::vector<std::string> recent_neurons;  // that sent most of them: "IFN.left[3] 2x"
};
inline constexpr double kRecentMs = 20;

struct NeuronWhy {
  std::string neuron;
  double time_ms = 0;
  bool fires = false;
  std::string model;
  NeuronAccount account;
  std::vector<NeuronShare> shares;  // largest first
};

/// The neuron's spike nearest to `at_s` within 50 ms, or that it did not fire then.
[[nodiscard]] NeuronWhy why_neuron(const RecordedCircuit& run, std::uint32_t neuron, double at_s);

struct OutputShare {
  std::string population;
  double rate_hz = 0, rate_before_hz = 0;  // over the output's window
  double gain = 0;
  std::string gain_unit;
};

/// A population whose activity changed, and what of its input changed most.
struct WhyHop {
  std::string population;
  double time_s = 0;                       // of the activity that counts for the hop before
  double rate_hz = 0, rate_before_hz = 0;  // over 10 ms, and over 40 ms before the movement
  std::size_t spikes = 0;                  // of it, in the movement so far
  std::string projection, where;           // through which the next hop acts on this one; empty at the last
  double input = 0, input_before = 0;      // that it brings to a neuron of this population, mean over a few of them
  double input_change_total = 0;           // of everything that changes in the same direction
  std::string unit;
  std::string note;  // at the last hop: what the fields show, or that nothing drives it
};

struct JointWhy {
  std::string joint;
  double time_s = 0;
  double goal_deg = 0;
  bool is_moving = false;
  std::optional<double> nearest_movement_s;  // of a joint that holds still: when it next moves or last moved
  double begin_s = 0, begin_deg = 0;         // of the movement
  std::string output;
  std::vector<OutputShare> terms;
  std::vector<WhyHop> hops;  // from the motoneurons inwards
};

/// Nothing when no output drives the joint, or there is no frame at that time.
[[nodiscard]] std::optional<JointWhy> why_joint(const RecordedCircuit& run, Joint joint, double at_s);

[[nodiscard]] std::string why_text(const NeuronWhy& why);
[[nodiscard]] std::string why_text(const JointWhy& why);
[[nodiscard]] std::string why_json(const NeuronWhy& why);
[[nodiscard]] std::string why_json(const JointWhy& why);

/// What JSON says of a computed number: no digit depends on the machine's mathematical library.
[[nodiscard]] double six_digits(double value);

/// "EBN.left[3]", or nothing with a line that says what is wrong with the name.
struct NamedNeuron {
  std::optional<std::uint32_t> neuron;
  std::string error;
};
[[nodiscard]] NamedNeuron find_neuron(const CircuitView& view, const std::string& name);

}  // namespace tectum
