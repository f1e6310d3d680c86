#include "tools/exchange/wiring.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compiler/lower/lower_model.h"
#include "compiler/validate/user_model.h"
#include "runtime/image/models.h"

namespace tectum {
std::string coherent_unit(const Dimension& dimension) {
  constexpr std::array<const char*, kBaseDimensionCount> kNames = {"ms", "mV", "nA", "deg", "m", "px"};
  std::string above;
  std::string below;
  for (std::size_t d = 0; d < kBaseDimensionCount; ++d) {
    const int exponent = dimension.exponents[d];
    const std::string power = std::abs(exponent) > 1 ? fmt::format("^{}", std::abs(exponent)) : "";
    if (exponent > 0) {
      above += (above.empty() ? "" : "*") + std::string(kNames[d]) + power;
    } else if (exponent < 0) {
      below += "/" + std::string(kNames[d]) + power;
    }
  }
  return above.empty() && !below.empty() ? "1" + below : above + below;
}

double weight_of(const Network& network, std::size_t synapse) {
  const Pathway& pathway = network.pathways[network.synapses.pathway[synapse]];
  return std::ldexp(network.synapses.quanta[synapse],
                    network.populations[pathway.post_population].quantum_log2[pathway.receptor]);
}

std::string weight_unit(const NetworkPopulation& population, std::uint32_t receptor) {
  if (population.user_model) {
    return coherent_unit(population.user_model->equations.inputs[receptor].dimension);
  }
  const std::string unit(find_model(population.model)->weight_unit);
  return unit == "1" ? "" : unit;
}

std::vector<double> parameter_of(const NetworkPopulation& population, std::string_view name) {
  ModelPhysics physics;
  physics.model = population.model;
  physics.size = population.size;
  physics.parameters = population.parameters;
  return parameter_values(physics, name);
}

std::string parameter_unit(const NetworkPopulation& population, std::string_view name) {
  if (population.user_model) {
    return coherent_unit(population.user_model->equations.parameter_dimension(name).value_or(Dimension{}));
  }
  return built_in_parameter_unit(population.model, name);
}

std::string built_in_parameter_unit(ModelKind model, std::string_view name) {
  const ModelInfo* info = find_model(model);
  const auto parameter = find_parameter(*info, name);
  const bool is_plain = model == ModelKind::Izhikevich || !parameter;
  return is_plain ? "" : std::string(info->parameters[*parameter].unit);
}

std::string_view model_name(const NetworkPopulation& population) {
  return population.user_model ? std::string_view(population.user_model->name) : find_model(population.model)->name;
}

std::string cell_name(const NetworkPopulation& population, std::uint32_t index) {
  return fmt::format("{}.{}", population.name, index);
}

std::string quantity_text(double value, std::string_view unit) { return fmt::format("{}{}", value, unit_text(unit)); }

std::string unit_text(std::string_view unit) {
  if (unit.substr(0, 2) != "1/") {
    return unit.empty() ? "" : " " + std::string(unit);
  }
  // "3 1/ms" is no quantity; "3 / 1 ms" is.
  std::string below(unit.substr(2));
  std::replace(below.begin(), below.end(), '/', '*');
  return " / 1 " + below;
}

}  // namespace tectum
