// A circuit as two of them are compared: everything by name, weights in physical units. Made from a spike image, and
// from its Network where there is one, which still knows which projection a synapse comes from.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "compiler/compile.h"
#include "runtime/image/load_image.h"

namespace tectum {

struct ParameterView {
  std::string name;
  std::string unit;
  std::vector<double> values;  // one for all neurons, or one a neuron
  [[nodiscard]] double of(std::size_t neuron) const { return values.size() == 1 ? values[0] : values[neuron]; }
};

struct ReceptorView {
  std::string name;
  ReceptorKind kind = ReceptorKind::Exponential;
  double tau_ms = 0;
  std::uint32_t window_ticks = 0;
  int quantum_log2 = 0;
};

/// One side of a population.
struct PopulationView {
  std::string name;  // "EBN.left"
  std::string nucleus;
  std::string model;
  std::string weight_unit;  // of synapses onto it
  std::uint32_t first_neuron = 0;
  std::uint32_t size = 0;
  bool is_retina = false;
  std::vector<ParameterView> parameters;
  std::vector<ReceptorView> receptors;
  std::vector<std::uint32_t> silenced;  // neurons of it, ascending
  std::vector<std::uint32_t> words;     // of an equation program or a spike list
};

/// Indices are of the neurons within their populations.
struct SynapseView {
  std::uint32_t pre = 0;
  std::uint32_t post = 0;
  std::uint32_t delay_ticks = 0;
  double weight = 0;  // signed
};

/// What a projection makes between two population sides; from an image alone, all that lies between them on a receptor.
struct PathwayView {
  std::string projection;
  std::uint32_t pre_population = 0;
  std::uint32_t post_population = 0;
  std::uint32_t receptor = 0;
  std::vector<SynapseView> synapses;  // ascending by (pre, post, delay, weight)
};

struct OutputView {
  std::string name;
  OutputKind kind = OutputKind::Position;
  std::uint32_t joint_mask = 0;
  double window_ms = 0;
  double offset_deg = 0;
  struct Term {
    std::uint32_t population = 0;
    double gain = 0;
  };
  std::vector<Term> terms;
};

/// A parameter or expression as the file has it.
struct WrittenValue {
  std::string text;
  std::string place;  // "circuits/oculomotor.json:52"
};

struct CircuitView {
  std::string path;
  SpikeImage image;
  std::vector<PopulationView> populations;
  std::vector<PathwayView> pathways;
  std::vector<OutputView> outputs;
  std::map<std::string, WrittenValue> parameters;   // empty for an image
  std::map<std::string, WrittenValue> weight_text;  // by projection
  std::map<std::string, WrittenValue> delay_text;
  bool has_projections = false;  // pathways know their projections

  [[nodiscard]] double tick_ms() const { return static_cast<double>(image.header.tick_ns) / 1e6; }
  [[nodiscard]] std::uint32_t population_of(std::uint32_t neuron) const;
};

[[nodiscard]] CircuitView view_of_image(std::string path, const SpikeImage& image);
/// `result` must hold the network, compiled without optimisation so that every synapse keeps its projection.
[[nodiscard]] CircuitView view_of_compilation(std::string path, const SpikeImage& image, const CompileResult& result);
/// The same view as of its image alone, to be compared with one that is.
void forget_projections(CircuitView& view);

/// "left" of "EBN.left", and the name before it; a name without a point has no side.
struct SidedName {
  std::string base;
  std::string side;
};
[[nodiscard]] SidedName sided_name(const std::string& name);

}  // namespace tectum
