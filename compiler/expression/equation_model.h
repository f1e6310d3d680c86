// Neuron models that a circuit declares by their equations.
//
//   check_equation_model    texts → EquationModel: names resolved, dimensions checked term by term
//   compile_equations       EquationModel + parameter values + tick → EquationProgram for the image
//
// What happens in one tick h, in this order:
//   1. all "dx/dt" equations advance together by h, with the inputs constant over the tick
//   2. each per-tick update "x" is assigned, in the order written, seeing the ones before it
//   3. a refractory neuron keeps the old values of its held states; any other fires if `threshold` is true,
//      then each reset is assigned in the order written
// Names in scope: parameters, states, inputs (what each receptor delivers in this tick), `dt` (the tick),
// then the circuit's own parameters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/expression/expression.h"

namespace tectum {

enum class EquationMethod : std::uint8_t {
  Unstated,          // exact when all "dx/dt" are linear; otherwise an error asks for a method
  Exact,             // matrix exponential at compile time; only for linear systems
  Euler,             // x += h f, all f with the old states
  ExponentialEuler,  // x += h phi(h a) f for dx/dt = a x + b, phi(z) = (e^z - 1)/z, a and b with the old states
};

struct EquationText {
  std::string name;  // of the parameter or state; "dv/dt" or "v" for an equation
  std::string text;
};

struct EquationInput {
  std::string name;  // of the receptor
  Dimension dimension;
};

/// The model as written.
struct EquationModelText {
  std::vector<EquationText> parameters;  // default values, constants; may use each other
  std::vector<EquationInput> inputs;     // one a receptor, in the order of the receptors
  std::vector<EquationText> states;      // initial values, of parameters only; give each state its dimension
  std::vector<EquationText> equations;
  std::string threshold;
  std::vector<EquationText> reset;
  std::string refractory;                        // a time in whole ticks; empty: none
  std::optional<std::vector<std::string>> hold;  // states; default: those that `threshold` names
  EquationMethod method = EquationMethod::Unstated;
};

enum class EquationPart : std::uint8_t { Parameter, Input, State, Equation, Threshold, Reset, Refractory, Hold };

enum class EquationErrorCode : std::uint8_t {
  Expression,         // see error.code
  DuplicateName,      // two parameters, states or inputs, or two equations of one state
  UnknownState,       // an equation, reset or hold of something that is no state
  CircularParameter,  // parameters that use each other
  NotConstant,        // an initial value or the refractory time uses a state or an input
  NotLinear,          // exact or exponential_euler where the equation does not allow it
  MethodNeeded,       // not linear and no method stated
  NotWholeTicks,      // the refractory time, or more than 65535 of them
  TooLarge,           // more states than a program can have
};

/// `error.span` counts from the start of the part's text, or of its name when `is_in_name`.
struct EquationError {
  EquationErrorCode code = EquationErrorCode::Expression;
  EquationPart part = EquationPart::Equation;
  std::size_t index = 0;
  bool is_in_name = false;
  ExprError error;
};

/// A checked model. Expressions are kept, because parameter values are bound later.
struct EquationModel {
  struct Parameter {
    std::string name;
    Dimension dimension;
    std::size_t index = 0;  // in the text's list
    Expression default_value;
  };
  struct State {
    std::string name;
    Dimension dimension;
    Expression initial;
  };
  struct Assignment {
    std::uint32_t state = 0;
    std::size_t index = 0;  // in the text's list
    Expression value;
  };
  std::vector<Parameter> parameters;  // in an order in which each uses only earlier ones
  std::vector<EquationInput> inputs;
  std::vector<State> states;
  std::vector<Assignment> derivatives;
  std::vector<Assignment> updates;
  Expression threshold;
  std::vector<Assignment> resets;
  std::optional<Expression> refractory;
  std::uint32_t hold_mask = 0;
  EquationMethod method = EquationMethod::Euler;  // never Unstated
  Environment circuit;                            // the constants of the circuit that were in scope

  [[nodiscard]] std::optional<Dimension> parameter_dimension(std::string_view name) const;
};

/// Reports every error it finds; returns a model only if there was none.
std::optional<EquationModel> check_equation_model(const EquationModelText& text, const Environment& circuit,
                                                  std::vector<EquationError>& errors);

/// The flat program of runtime/image/program.h with its arrays.
struct EquationProgram {
  std::vector<std::uint32_t> words;
  std::vector<double> constants;
  std::vector<std::vector<double>> columns;  // each one value a neuron
};

/// Coherent values by parameter name, one for all neurons or one a neuron; missing ones take the default.
using EquationParameterValues = std::map<std::string, std::vector<double>, std::less<>>;

/// Fails, with errors, only where values matter: a constant that is not finite, a refractory time that
/// is no whole number of ticks.
std::optional<EquationProgram> compile_equations(const EquationModel& model, const EquationParameterValues& values,
                                                 std::uint32_t size, double tick_ms,
                                                 std::vector<EquationError>& errors);

}  // namespace tectum
