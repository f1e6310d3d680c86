#include "tools/exchange/sonata_types.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/image/models.h"

namespace tectum {
namespace {

// A node type is a file of its own: beyond this, parameters go into nodes.h5 neuron by neuron.
constexpr std::size_t kMaxTypes = 1000;

double value_at(const std::vector<double>& values, std::size_t i) { return values.size() == 1 ? values[0] : values[i]; }

/// A built-in model's parameters that have no counterpart in NEST, in Tectum's own names; of a declared model those
/// that are given.
NeuronValues native_parameters(const NetworkPopulation& population) {
  NeuronValues values(population.parameters.begin(), population.parameters.end());
  if (!population.user_model) {
    for (const ParameterInfo& parameter : find_model(population.model)->parameters) {
      values[std::string(parameter.name)] = parameter_of(population, parameter.name);
    }
  }
  return values;
}

NeuronValues kept_parameters(const NetworkPopulation& population) {
  NeuronValues values;
  const ModelInfo* info = population.user_model ? nullptr : find_model(population.model);
  for (const char* name : kKeptParameters) {
    if (info != nullptr && find_parameter(*info, name)) {
      values[name] = parameter_of(population, name);
    }
  }
  return values;
}

/// Numbers each neuron's combination of values by first appearance.
class Combinations {
 public:
  Combinations(std::uint32_t size, std::vector<const NeuronValues*> tables) : tables_(std::move(tables)) {
    std::map<std::vector<double>, std::size_t> number;
    std::vector<double> key;
    for (std::uint32_t i = 0; i < size; ++i) {
      key.clear();
      for (const NeuronValues* table : tables_) {
        for (const auto& [name, values] : *table) {
          if (values.size() > 1) {
            key.push_back(values[i]);
          }
        }
      }
      const auto [entry, is_new] = number.emplace(key, first.size());
      if (is_new) {
        first.push_back(i);
      }
      of.push_back(entry->second);
    }
  }
  std::vector<std::uint32_t> first;  // a neuron of each
  std::vector<std::size_t> of;       // each neuron's

 private:
  std::vector<const NeuronValues*> tables_;
};

/// Numbers in NEST's units; quantities with their unit where only Tectum reads them.
SonataNodeType type_at(const NetworkPopulation& population, const NestModel& nest, const NeuronValues& parameters,
                       const NeuronValues& kept, std::uint32_t neuron) {
  SonataNodeType type;
  type.dynamics = nlohmann::ordered_json::object();
  for (const auto& [name, values] : parameters) {
    const double value = value_at(values, neuron);
    if (nest.name.empty()) {
      type.dynamics[name] = quantity_text(value, parameter_unit(population, name));
    } else {
      type.dynamics[name] = value;
    }
  }
  for (const auto& [name, list] : nest.lists) {
    type.dynamics[name] = list;
  }
  for (const auto& [name, flag] : nest.flags) {
    type.dynamics[name] = flag;
  }
  for (const auto& [name, values] : kept) {
    type.kept[name] = value_at(values, neuron);
  }
  return type;
}

void take_varying(NeuronValues& from, NeuronValues& to) {
  for (const auto& [name, values] : from) {
    if (values.size() > 1) {
      to[name] = values;
    }
  }
}

}  // namespace

std::string receptors_text(const std::vector<Receptor>& receptors) {
  std::string text;
  for (const Receptor& receptor : receptors) {
    text += (text.empty() ? "" : ",") + fmt::format("{}:{}", receptor.name, receptor_kind_name(receptor.kind));
    if (receptor.kind == ReceptorKind::Exponential) {
      text += fmt::format(":{}", receptor.tau_ms);
    } else if (receptor.kind == ReceptorKind::Boxcar) {
      text += fmt::format(":{}", receptor.window_ticks);
    }
  }
  return text.empty() ? "NULL" : text;
}

SonataPopulation sonata_population(const NetworkPopulation& population, double tick_ms, bool splits_by_sign,
                                   std::uint64_t first_type) {
  SonataPopulation made;
  made.nest = nest_model(population, tick_ms, splits_by_sign);
  made.receptors = receptors_text(population.receptors);
  const bool is_virtual = population.model == ModelKind::FieldSource || population.model == ModelKind::SpikeList;
  const bool is_generator = population.model == ModelKind::Poisson;
  made.kind = is_virtual ? "virtual" : is_generator ? "generator" : "neuron";
  made.model_type = is_virtual ? "virtual" : is_generator ? "point_process" : "point_neuron";
  made.model_template = is_virtual               ? "NULL"
                        : made.nest.name.empty() ? fmt::format("tectum:{}", model_name(population))
                                                 : "nest:" + made.nest.name;
  NeuronValues parameters = made.nest.name.empty() ? native_parameters(population) : made.nest.parameters;
  NeuronValues kept = made.nest.name.empty() ? NeuronValues{} : kept_parameters(population);
  Combinations combinations(population.size, {&parameters, &kept});
  if (combinations.first.size() > kMaxTypes) {
    take_varying(parameters, made.single);
    take_varying(kept, made.single_kept);
    combinations.first = {0};
    std::fill(combinations.of.begin(), combinations.of.end(), 0);
  }
  for (const std::uint32_t neuron : combinations.first) {
    made.types.push_back(type_at(population, made.nest, parameters, kept, neuron));
    made.types.back().id = first_type + made.types.size() - 1;
  }
  for (const std::size_t type : combinations.of) {
    made.type_of.push_back(first_type + type);
  }
  return made;
}

}  // namespace tectum
