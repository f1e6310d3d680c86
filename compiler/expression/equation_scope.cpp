#include "compiler/expression/equation_scope.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tectum {
namespace {

// Adds parameters [0, count), whose values are known.
void add_parameters(const EquationModel& model, const BoundParameters& bound, std::size_t count, Environment& scope) {
  for (std::size_t p = 0; p < count; ++p) {
    const EquationModel::Parameter& parameter = model.parameters[p];
    if (bound.varies(p)) {
      scope.add_variable(parameter.name, parameter.dimension, parameter_slot(model, p));
    } else {
      scope.add_constant(parameter.name, {bound.values[p][0], parameter.dimension});
    }
  }
}

Environment empty_scope(const EquationModel& model) {
  Environment scope;
  scope.outer = &model.circuit;
  return scope;
}

void collapse(std::vector<double>& values) {
  const bool is_same = std::all_of(values.begin(), values.end(), [&](double value) { return value == values[0]; });
  if (is_same) {
    values.resize(1);
  }
}

}  // namespace

std::uint32_t parameter_slot(const EquationModel& model, std::size_t p) {
  return static_cast<std::uint32_t>(model.states.size() + model.inputs.size() + p);
}

Environment equation_scope(const EquationModel& model, const std::optional<BoundParameters>& bound) {
  Environment scope = empty_scope(model);
  if (bound) {
    add_parameters(model, *bound, model.parameters.size(), scope);
  } else {
    std::vector<EquationError> none;
    const auto defaults = bind_parameters(model, {}, 1, 1, none);
    assert(defaults && "defaults were evaluated when the model was checked");
    add_parameters(model, *defaults, model.parameters.size(), scope);
  }
  scope.add_constant("dt", {bound ? bound->tick_ms : 1, kTime});
  std::uint32_t slot = 0;
  for (const EquationModel::State& state : model.states) {
    scope.add_variable(state.name, state.dimension, slot++);
  }
  for (const EquationInput& input : model.inputs) {
    scope.add_variable(input.name, input.dimension, slot++);
  }
  return scope;
}

std::optional<BoundParameters> bind_parameters(const EquationModel& model, const EquationParameterValues& values,
                                               std::uint32_t size, double tick_ms, std::vector<EquationError>& errors) {
  BoundParameters bound;
  bound.tick_ms = tick_ms;
  Environment scope = empty_scope(model);
  for (std::size_t p = 0; p < model.parameters.size(); ++p) {
    const EquationModel::Parameter& parameter = model.parameters[p];
    if (const auto given = values.find(parameter.name); given != values.end()) {
      assert(given->second.size() == 1 || given->second.size() == size);
      bound.values.push_back(given->second);
    } else {
      std::vector<ExprError> found;
      const auto typed = type_expression(parameter.default_value, scope, found);
      for (ExprError& error : found) {
        errors.push_back(
            {EquationErrorCode::Expression, EquationPart::Parameter, parameter.index, false, std::move(error)});
      }
      if (!typed) {
        return std::nullopt;
      }
      bound.values.push_back(parameter_expression_values(model, bound, *typed, size));
    }
    collapse(bound.values.back());
    scope = empty_scope(model);
    add_parameters(model, bound, p + 1, scope);
  }
  return bound;
}

std::vector<double> parameter_expression_values(const EquationModel& model, const BoundParameters& bound,
                                                const TypedExpression& expression, std::uint32_t size) {
  if (expression.constant) {
    return {*expression.constant};
  }
  std::vector<EvalColumn> columns(std::max<std::size_t>(expression.slot_count, parameter_slot(model, 0)));
  for (std::size_t p = 0; p < bound.values.size(); ++p) {
    const std::size_t slot = parameter_slot(model, p);
    if (slot < columns.size()) {
      columns[slot] = {bound.values[p].data(), bound.varies(p) ? 1U : 0U};
    }
  }
  std::vector<double> result(size);
  Evaluator(expression).evaluate(columns, result);
  return result;
}

}  // namespace tectum
