// A circuit written out: every neuron and every synapse. No expression, rule or side relation is left.
//
// Synapses are columns in the order in which projections made them. A weight is an integer number of quanta of
// its target's receptor from the start, so that no later pass can change a rounding: sums of quanta are exact.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "compiler/source/source_file.h"
#include "compiler/validate/circuit.h"
#include "runtime/image/spike_image.h"

namespace tectum {

/// One side of a population: neurons [first_neuron, first_neuron + size).
struct NetworkPopulation {
  std::string name;
  std::string nucleus;
  Span name_span;
  ModelKind model = ModelKind::LifExp;
  std::shared_ptr<const UserModel> user_model;  // of ModelKind::Program
  bool may_sleep = false;
  std::uint32_t first_neuron = 0;
  std::uint32_t size = 0;
  std::map<std::string, std::vector<double>> parameters;
  std::vector<Receptor> receptors;
  std::vector<std::int32_t> quantum_log2;       // one a receptor: physical weight = quanta * 2^quantum_log2
  std::vector<std::uint32_t> spike_ticks;       // spike_list
  std::vector<std::uint32_t> silenced_neurons;  // local indices, ascending: lesioned, they never fire
};

/// How one pathway learns.
struct PlasticRule {
  Plasticity plasticity;
  RewardChannel channel = RewardChannel::Pan;
  std::uint32_t listed_count = 0;  // synapses of the pathway, before lesions
};

inline constexpr std::uint32_t kNoRule = 0xFFFFFFFFU;

/// What one projection makes between two population sides. Synapses point here: it is their origin.
struct Pathway {
  ProjectionId projection{};
  std::string name;  // the projection's
  std::string cite;
  Span name_span;
  std::uint32_t pre_population = 0;
  std::uint32_t post_population = 0;
  std::uint32_t receptor = 0;
  std::uint32_t rule = kNoRule;  // of Network::rules: its synapses learn
};

struct Synapses {
  std::vector<std::uint32_t> pre;   // neuron
  std::vector<std::uint32_t> post;  // neuron
  std::vector<std::int32_t> quanta;
  std::vector<std::uint32_t> delay_ticks;
  std::vector<std::uint32_t> pathway;
  // Empty in a network where nothing learns. Of synapses that learn: `quanta` is base_quanta * scale.
  std::vector<std::int32_t> base_quanta;
  std::vector<std::int32_t> scale;     // in 2^-kScaleBits
  std::vector<std::uint32_t> ordinal;  // in the pathway, as made

  [[nodiscard]] std::size_t size() const { return pre.size(); }
};

struct NetworkRetina {
  RetinaSheet retina;
  std::uint32_t population = 0;
};

struct Network {
  std::string name;
  std::uint64_t tick_ns = 0;
  std::uint64_t seed = 0;
  std::vector<NetworkPopulation> populations;
  std::vector<Pathway> pathways;
  std::vector<PlasticRule> rules;
  Synapses synapses;
  std::vector<NetworkRetina> retinas;
  std::vector<Output> outputs;  // a term's instance is an index into populations
  std::vector<JointSetting> joints;
  bool shares_constant_weights = false;    // the image may store one weight for a run of equal ones
  std::vector<std::uint32_t> layout_rank;  // of each population in the engine's memory; empty: as written

  [[nodiscard]] double tick_ms() const { return static_cast<double>(tick_ns) / 1e6; }
  [[nodiscard]] std::uint32_t neuron_count() const {
    return populations.empty() ? 0 : populations.back().first_neuron + populations.back().size;
  }
};

/// Text of the network: populations, pathways with their counts, and at most `max_synapses` synapses.
[[nodiscard]] std::string dump_network(const Network& network, std::size_t max_synapses);

}  // namespace tectum
