#include "compiler/elaborate/analyse.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

namespace tectum {
namespace {

bool is_source(ModelKind model) {
  return model == ModelKind::FieldSource || model == ModelKind::Poisson || model == ModelKind::SpikeList;
}

/// A constant input may be what drives it; whether it suffices is physiology.
bool has_bias(const NetworkPopulation& population) {
  const auto bias = population.parameters.find("I_bias");
  return bias != population.parameters.end() &&
         std::any_of(bias->second.begin(), bias->second.end(), [](double value) { return value != 0; });
}

class Analysis {
 public:
  Analysis(const Circuit& circuit, const Network& network, const std::vector<double>& weights, Diagnostics& diagnostics)
      : circuit_(circuit), network_(network), diagnostics_(diagnostics) {
    has_synapse_.assign(network.pathways.size(), false);
    sends_.assign(network.populations.size(), {});
    for (std::size_t s = 0; s < network.synapses.size(); ++s) {
      const std::uint32_t p = network.synapses.pathway[s];
      has_synapse_[p] = true;
      const Pathway& pathway = network.pathways[p];
      auto& first = weights[s] > 0 ? sends_[pathway.pre_population].excites : sends_[pathway.pre_population].inhibits;
      if (weights[s] != 0 && !first) {
        first = p;
      }
    }
  }

  void undriven() {
    std::vector<bool> is_driven(network_.populations.size(), false);
    for (std::size_t p = 0; p < network_.pathways.size(); ++p) {
      is_driven[network_.pathways[p].post_population] =
          is_driven[network_.pathways[p].post_population] || has_synapse_[p];
    }
    for (std::size_t i = 0; i < is_driven.size(); ++i) {
      const NetworkPopulation& population = network_.populations[i];
      is_driven[i] =
          is_driven[i] || is_source(population.model) || population.model == ModelKind::Program || has_bias(population);
    }
    report_missing(Code::Undriven, is_driven);
  }

  void reaches_no_output() {
    if (network_.outputs.empty()) {
      return;
    }
    std::vector<bool> reaches(network_.populations.size(), false);
    for (const Output& output : network_.outputs) {
      for (const OutputTerm& term : output.terms) {
        reaches[index_of(term.instance)] = true;
      }
    }
    for (bool has_grown = true; has_grown;) {
      has_grown = false;
      for (std::size_t p = 0; p < network_.pathways.size(); ++p) {
        const Pathway& pathway = network_.pathways[p];
        if (has_synapse_[p] && reaches[pathway.post_population] && !reaches[pathway.pre_population]) {
          reaches[pathway.pre_population] = true;
          has_grown = true;
        }
      }
    }
    report_missing(Code::ReachesNoOutput, reaches);
  }

  /// Dale's principle: one neuron, one sign.
  void mixed_signs() {
    for (const Population& population : circuit_.populations) {
      for (std::uint32_t k = 0; k < population.instance_count; ++k) {
        const Sends& sends = sends_[index_of(population.first_instance) + k];
        if (sends.excites && sends.inhibits && !population.may_mix_signs) {
          diagnostics_.add(Code::DaleViolated, population.name_span, {population.name})
              .label(network_.pathways[*sends.excites].name_span, "excites here")
              .label(network_.pathways[*sends.inhibits].name_span, "inhibits here")
              .help("split it into two populations, or say why it is meant: \"mixed_signs\": \"stands for ...\"");
          break;
        }
      }
    }
  }

  void uncited() {
    const auto is_uncited = [](const Projection& projection) { return projection.cite.empty(); };
    const auto first = std::find_if(circuit_.projections.begin(), circuit_.projections.end(), is_uncited);
    if (!circuit_.has_references || first == circuit_.projections.end()) {
      return;
    }
    const auto count = std::count_if(circuit_.projections.begin(), circuit_.projections.end(), is_uncited);
    diagnostics_
        .add(Code::Uncited, first->name_span,
             {fmt::format("{}", count), fmt::format("{}", circuit_.projections.size())})
        .help("this is the first; `tectum check --provenance` lists them all");
  }

 private:
  struct Sends {
    std::optional<std::uint32_t> excites;  // first pathway that does
    std::optional<std::uint32_t> inhibits;
  };

  /// One warning a population; it names the side when only some sides are meant.
  void report_missing(Code code, const std::vector<bool>& has_it) {
    for (const Population& population : circuit_.populations) {
      const std::size_t first = index_of(population.first_instance);
      std::vector<std::string> names;
      for (std::size_t i = first; i < first + population.instance_count; ++i) {
        if (!has_it[i]) {
          names.push_back(network_.populations[i].name);
        }
      }
      if (names.size() == population.instance_count) {
        diagnostics_.add(code, population.name_span, {population.name});
      } else {
        for (const std::string& name : names) {
          diagnostics_.add(code, population.name_span, {name});
        }
      }
    }
  }

  const Circuit& circuit_;
  const Network& network_;
  Diagnostics& diagnostics_;
  std::vector<bool> has_synapse_;  // pathway by pathway
  std::vector<Sends> sends_;       // population by population
};

}  // namespace

void analyse(const Circuit& circuit, const Network& network, const std::vector<double>& weights,
             Diagnostics& diagnostics) {
  Analysis analysis(circuit, network, weights, diagnostics);
  analysis.undriven();
  analysis.reaches_no_output();
  analysis.mixed_signs();
  analysis.uncited();
}

}  // namespace tectum
