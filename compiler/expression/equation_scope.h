// The names that an equation model's expressions see, and the values behind them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compiler/expression/equation_model.h"

namespace tectum {

/// Parameter values in the model's order: one for all neurons, or one a neuron.
struct BoundParameters {
  std::vector<std::vector<double>> values;
  double tick_ms = 1;

  [[nodiscard]] bool varies(std::size_t p) const { return values[p].size() > 1; }
};

/// Slots: states, then inputs, then parameters. A parameter that varies is a variable in its slot, any
/// other a constant. Without values every parameter has its default, and the tick is 1 ms.
/// The model must outlive the result.
Environment equation_scope(const EquationModel& model, const std::optional<BoundParameters>& bound);

/// Slot of parameter p.
std::uint32_t parameter_slot(const EquationModel& model, std::size_t p);

/// Evaluates defaults and spreads the given values; a parameter whose values are all the same has one.
/// Appends errors and returns nothing if a default has no finite value.
std::optional<BoundParameters> bind_parameters(const EquationModel& model, const EquationParameterValues& values,
                                               std::uint32_t size, double tick_ms, std::vector<EquationError>& errors);

/// The value of an expression over parameters only: one for all neurons, or one a neuron.
std::vector<double> parameter_expression_values(const EquationModel& model, const BoundParameters& bound,
                                                const TypedExpression& expression, std::uint32_t size);

}  // namespace tectum
