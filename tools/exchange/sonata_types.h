// Node types: neurons of a population that have the same parameters, as NEST wants them told apart.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/exchange/nest_model.h"
#include "tools/exchange/wiring.h"

namespace tectum {

/// Parameters that NEST's units round, kept beside as columns tectum_...
inline constexpr const char* kKeptParameters[] = {"tau_m", "R_m", "I_bias", "b_w"};

struct SonataNodeType {
  std::uint64_t id = 0;
  nlohmann::ordered_json dynamics;     // parameters by their names in the model template's simulator
  std::map<std::string, double> kept;  // of kKeptParameters, in Tectum's units
};

struct SonataPopulation {
  std::string kind;            // "neuron", "generator" or "virtual"
  std::string model_type;      // of SONATA
  std::string model_template;  // "nest:iaf_psc_exp", "tectum:threshold", "NULL"
  NestModel nest;
  std::string receptors;  // "ex:exponential:2,in:exponential:5"
  std::vector<SonataNodeType> types;
  std::vector<std::uint64_t> type_of;  // of each neuron
  NeuronValues single;                 // by NEST's names; parameters that are stored neuron by neuron instead
  NeuronValues single_kept;
};

/// Node type ids start at `first_type`. `splits_by_sign` as in nest_model().
[[nodiscard]] SonataPopulation sonata_population(const NetworkPopulation& population, double tick_ms,
                                                 bool splits_by_sign, std::uint64_t first_type);

/// A boxcar's window follows in ticks, an exponential's time constant in ms.
[[nodiscard]] std::string receptors_text(const std::vector<Receptor>& receptors);

}  // namespace tectum
