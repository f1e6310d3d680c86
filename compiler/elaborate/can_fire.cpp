#include "compiler/elaborate/can_fire.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "runtime/image/models.h"

namespace tectum {
namespace {

// A membrane that rests this close to its threshold counts as able to fire: rounding in the engine stays far below.
constexpr double kMarginMv = 1e-3;

/// One population's parameter as given or by default, neuron by neuron.
class ParameterColumn {
 public:
  ParameterColumn(const NetworkPopulation& population, const ModelInfo& model, std::string_view name) {
    const auto given = population.parameters.find(std::string(name));
    if (given != population.parameters.end()) {
      values_ = given->second;
      return;
    }
    const ParameterInfo& info = model.parameters[find_parameter(model, name).value()];
    values_ = info.default_text.empty() ? std::vector<double>{info.default_value}
                                        : ParameterColumn(population, model, info.default_text).values_;
  }

  [[nodiscard]] double operator[](std::uint32_t i) const { return values_.size() == 1 ? values_[0] : values_[i]; }

 private:
  std::vector<double> values_;
};

/// Marks the neurons that can fire although nothing reaches them.
void mark_spontaneous(const NetworkPopulation& population, std::vector<bool>& can_fire) {
  const ModelInfo* const model = find_model(population.model);
  const auto mark_where = [&](const auto& is_active) {
    for (std::uint32_t i = 0; i < population.size; ++i) {
      can_fire[population.first_neuron + i] = is_active(i);
    }
  };
  switch (population.model) {
    case ModelKind::FieldSource:
    case ModelKind::Izhikevich:
    case ModelKind::Program:
      mark_where([](std::uint32_t) { return true; });
      return;
    case ModelKind::SpikeList:
      mark_where([&](std::uint32_t) { return !population.spike_ticks.empty(); });
      return;
    case ModelKind::Poisson: {
      const ParameterColumn rate_hz(population, *model, "rate");
      mark_where([&](std::uint32_t i) { return rate_hz[i] > 0; });
      return;
    }
    case ModelKind::Threshold: {
      const ParameterColumn theta(population, *model, "theta");
      mark_where([&](std::uint32_t i) { return theta[i] <= 0; });
      return;
    }
    case ModelKind::LifDelta:
    case ModelKind::LifExp:
    case ModelKind::Alif: {
      // From its start the membrane goes to where it rests and never beyond.
      const ParameterColumn rest_mv(population, *model, "E_L");
      const ParameterColumn start_mv(population, *model, "V_init");
      const ParameterColumn threshold_mv(population, *model, "V_th");
      const ParameterColumn bias_na(population, *model, "I_bias");
      const ParameterColumn r_m_mohm(population, *model, "R_m");
      mark_where([&](std::uint32_t i) {
        const double rests_at_mv = rest_mv[i] + r_m_mohm[i] * bias_na[i];
        return std::max(rests_at_mv, start_mv[i]) > threshold_mv[i] - kMarginMv;
      });
      return;
    }
  }
}

}  // namespace

std::vector<bool> neurons_that_can_fire(const Network& network) {
  std::vector<bool> can_fire(network.neuron_count(), false);
  for (const NetworkPopulation& population : network.populations) {
    mark_spontaneous(population, can_fire);
    for (const std::uint32_t i : population.silenced_neurons) {
      can_fire[population.first_neuron + i] = false;
    }
  }
  const Synapses& synapses = network.synapses;
  // Lesions have cut every synapse onto a silenced neuron.
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (std::size_t s = 0; s < synapses.size(); ++s) {
      if (can_fire[synapses.pre[s]] && !can_fire[synapses.post[s]]) {
        can_fire[synapses.post[s]] = true;
        has_grown = true;
      }
    }
  }
  return can_fire;
}

}  // namespace tectum
