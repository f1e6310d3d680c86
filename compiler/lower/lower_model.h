// From physical neuron parameters to the propagators of one update group.
// Every exp() of the product is evaluated here, so that no libm runs in the loop.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/image/image_contents.h"

namespace tectum {

struct ReceptorPhysics {
  std::string name;  // "ex", "in", or the circuit's own
  ReceptorKind kind = ReceptorKind::Exponential;
  double tau_ms = 0;               // Exponential
  std::uint32_t window_ticks = 0;  // Boxcar
};

/// One population's neurons. Parameters are keyed by their language name, in the fixed units
/// mV, ms, nA, MOhm, Hz; a parameter with one value holds for all neurons, otherwise there is one a neuron.
struct ModelPhysics {
  ModelKind model = ModelKind::LifExp;
  std::uint32_t size = 0;
  std::map<std::string, std::vector<double>> parameters;
  std::vector<ReceptorPhysics> receptors;
  bool may_sleep = false;
};

/// True when the parameter of that language name may have one value a neuron. False for a name that
/// the model does not have.
[[nodiscard]] bool parameter_may_vary(ModelKind model, std::string_view name);

/// The resting state lies below threshold for every neuron, so the population can be let sleep.
/// False for models that never sleep.
[[nodiscard]] bool rests_below_threshold(const ModelPhysics& model);

/// Parameter `name` as given or by default: one value for all neurons, or one a neuron. Needs: a parameter of the
/// model.
[[nodiscard]] std::vector<double> parameter_values(const ModelPhysics& model, std::string_view name);

/// Appends the group's parameters, columns and tables to `image` and fills the model part of
/// `group` (model, flags and the parameter, column and table ranges).
/// Leaves the neuron, slot, receptor and data ranges alone: the caller sets them. Parameters
/// that are left out take the default of runtime/image/models.h.
/// Needs: names and sizes checked, time constants and periods positive, t_ref in whole ticks.
void lower_model(const ModelPhysics& model, double tick_ms, ImageContents& image, GroupRecord& group);

}  // namespace tectum
