#include "compiler/expression/equation_model.h"

#include <algorithm>

#include "compiler/expression/equation_scope.h"
#include "compiler/expression/expression_text.h"
#include "compiler/expression/linear_split.h"
#include "runtime/image/program.h"

namespace tectum {
namespace {

ExprSpan whole(std::string_view text) { return {0, static_cast<std::uint32_t>(text.size())}; }

// "dv/dt" → "v"; anything else is a per-tick update of the state it names.
std::optional<std::string_view> derivative_of(std::string_view key) {
  constexpr std::string_view kBehind = "/dt";
  const bool is_derivative = key.size() > 1 + kBehind.size() && key.front() == 'd' && key.ends_with(kBehind);
  return is_derivative ? std::optional(key.substr(1, key.size() - 1 - kBehind.size())) : std::nullopt;
}

class Checker {
 public:
  Checker(const EquationModelText& text, const Environment& circuit, std::vector<EquationError>& errors)
      : text_(text), errors_(errors), first_error_(errors.size()) {
    // Flat, so that the model does not point into the caller's scopes. Inner names hide outer ones.
    for (const Environment* scope = &circuit; scope; scope = scope->outer) {
      model_.circuit.symbols.insert(scope->symbols.begin(), scope->symbols.end());
    }
    model_.inputs = text.inputs;
  }

  std::optional<EquationModel> check() {
    check_names();
    check_parameters();
    check_states();
    // Equations over unknown names would only report consequences.
    if (has_errors()) {
      return std::nullopt;
    }
    scope_ = equation_scope(model_, {});
    check_equations();
    check_threshold();
    check_resets();
    check_refractory();
    check_hold();
    if (!has_errors()) {
      check_method();
    }
    return has_errors() ? std::nullopt : std::optional(std::move(model_));
  }

 private:
  [[nodiscard]] bool has_errors() const { return errors_.size() > first_error_; }

  void fail(EquationErrorCode code, EquationPart part, std::size_t index, bool is_in_name, ExprError error) {
    errors_.push_back({code, part, index, is_in_name, std::move(error)});
  }

  void fail_expression(EquationPart part, std::size_t index, std::vector<ExprError> found) {
    for (ExprError& error : found) {
      fail(EquationErrorCode::Expression, part, index, false, std::move(error));
    }
  }

  // ---- names ----
  void check_names() {
    std::map<std::string_view, std::string_view> kinds;
    const auto add = [&](std::string_view name, std::string_view kind, EquationPart part, std::size_t index) {
      const auto [known, is_new] = kinds.emplace(name, kind);
      if (is_new) {
        return;
      }
      ExprError error{ExprErrorCode::UnknownName,
                      whole(name),
                      quoted(name) + " is already a " + std::string(known->second),
                      {},
                      std::nullopt,
                      {}};
      fail(EquationErrorCode::DuplicateName, part, index, true, std::move(error));
    };
    add("dt", "name of the tick", EquationPart::Parameter, 0);
    for (std::size_t i = 0; i < text_.parameters.size(); ++i) {
      add(text_.parameters[i].name, "parameter", EquationPart::Parameter, i);
    }
    for (std::size_t i = 0; i < text_.inputs.size(); ++i) {
      add(text_.inputs[i].name, "receptor", EquationPart::Input, i);
    }
    for (std::size_t i = 0; i < text_.states.size(); ++i) {
      add(text_.states[i].name, "state", EquationPart::State, i);
    }
  }

  // ---- parameters: any order of writing; each pass takes those whose names are all known ----
  void check_parameters() {
    struct Waiting {
      std::size_t index;
      Expression value;
    };
    std::vector<Waiting> waiting;
    for (std::size_t i = 0; i < text_.parameters.size(); ++i) {
      std::vector<ExprError> found;
      if (auto value = parse_expression(text_.parameters[i].text, found)) {
        waiting.push_back({i, std::move(*value)});
      } else {
        broken_parameters_.push_back(text_.parameters[i].name);
      }
      fail_expression(EquationPart::Parameter, i, std::move(found));
    }
    const auto waits_for = [&](const Waiting& one, std::string_view name) {
      return std::any_of(
                 waiting.begin(), waiting.end(),
                 [&](const Waiting& other) { return text_.parameters[other.index].name == name && &other != &one; }) ||
             text_.parameters[one.index].name == name;
    };
    Environment known;
    known.outer = &model_.circuit;
    for (bool is_progress = true; is_progress && !waiting.empty();) {
      is_progress = false;
      for (std::size_t w = 0; w < waiting.size();) {
        const std::vector<NameUse> names = names_in(waiting[w].value);
        const bool must_wait = std::any_of(names.begin(), names.end(),
                                           [&](const NameUse& use) { return waits_for(waiting[w], use.name); });
        if (must_wait) {
          ++w;
          continue;
        }
        Waiting ready = std::move(waiting[w]);
        waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(w));
        add_parameter(ready.index, std::move(ready.value), known);
        is_progress = true;
      }
    }
    if (!waiting.empty()) {
      fail_circle(waiting.front().index, waiting.front().value);
    }
  }

  void add_parameter(std::size_t index, Expression value, Environment& known) {
    const std::string& name = text_.parameters[index].name;
    const std::vector<NameUse> names = names_in(value);
    const bool follows = std::any_of(names.begin(), names.end(), [&](const NameUse& use) {
      return std::find(broken_parameters_.begin(), broken_parameters_.end(), use.name) != broken_parameters_.end();
    });
    std::vector<ExprError> found;
    const auto typed = follows ? std::nullopt : type_expression(value, known, found);
    fail_expression(EquationPart::Parameter, index, std::move(found));
    if (!typed || !typed->constant) {
      broken_parameters_.push_back(name);
      return;
    }
    known.add_constant(name, {*typed->constant, typed->dimension});
    model_.parameters.push_back({name, typed->dimension, index, std::move(value)});
  }

  void fail_circle(std::size_t index, const Expression& value) {
    const std::string& name = text_.parameters[index].name;
    ExprError error{
        ExprErrorCode::NotConstant, whole(value.text), quoted(name) + " depends on itself", {}, std::nullopt, {}};
    fail(EquationErrorCode::CircularParameter, EquationPart::Parameter, index, false, std::move(error));
  }

  // ---- states ----
  void check_states() {
    if (text_.states.size() > kMaxProgramStates) {
      const std::string& name = text_.states[kMaxProgramStates].name;
      ExprError error{ExprErrorCode::TooComplex,
                      whole(name),
                      "more than " + std::to_string(kMaxProgramStates) + " states",
                      {},
                      std::nullopt,
                      {}};
      fail(EquationErrorCode::TooLarge, EquationPart::State, kMaxProgramStates, true, std::move(error));
    }
    if (has_errors()) {
      return;
    }
    const Environment constants = equation_scope(model_, {});  // no states yet
    for (std::size_t i = 0; i < text_.states.size(); ++i) {
      std::vector<ExprError> found;
      auto initial = parse_expression(text_.states[i].text, found);
      if (initial && !uses_variables(*initial, EquationPart::State, i)) {
        if (const auto typed = type_expression(*initial, constants, found)) {
          model_.states.push_back({text_.states[i].name, typed->dimension, std::move(*initial)});
        }
      }
      fail_expression(EquationPart::State, i, std::move(found));
    }
  }

  // Reports a state or input where only constants may stand.
  bool uses_variables(const Expression& expression, EquationPart part, std::size_t index) {
    for (const NameUse& use : names_in(expression)) {
      const auto is_named = [&](const auto& item) { return item.name == use.name; };
      const bool is_state = std::any_of(text_.states.begin(), text_.states.end(), is_named);
      const bool is_input = std::any_of(text_.inputs.begin(), text_.inputs.end(), is_named);
      if (!is_state && !is_input) {
        continue;
      }
      ExprError error{
          ExprErrorCode::NotConstant,
          use.span,
          quoted(use.name) + " is a " + (is_state ? "state" : "receptor") + ", and a constant is expected here",
          {},
          std::nullopt,
          {}};
      fail(EquationErrorCode::NotConstant, part, index, false, std::move(error));
      return true;
    }
    return false;
  }

  std::optional<std::uint32_t> state_index(std::string_view name) const {
    for (std::uint32_t s = 0; s < model_.states.size(); ++s) {
      if (model_.states[s].name == name) {
        return s;
      }
    }
    return std::nullopt;
  }

  std::optional<std::uint32_t> known_state(std::string_view name, EquationPart part, std::size_t index, ExprSpan span) {
    const std::optional<std::uint32_t> found = state_index(name);
    if (!found) {
      std::vector<std::string> names;
      for (const EquationModel::State& state : model_.states) {
        names.push_back(state.name);
      }
      const std::optional<std::string> nearest = nearest_name(name, names);
      ExprError error{ExprErrorCode::UnknownName,
                      span,
                      "unknown state " + quoted(name),
                      nearest ? "did you mean " + quoted(*nearest) + "?" : "",
                      std::nullopt,
                      {}};
      fail(EquationErrorCode::UnknownState, part, index, true, std::move(error));
    }
    return found;
  }

  // The expression, when it has the wanted dimension.
  std::optional<Expression> checked(std::string_view text, const Dimension& wanted, EquationPart part,
                                    std::size_t index) {
    std::vector<ExprError> found;
    auto expression = parse_expression(text, found);
    if (expression) {
      const auto typed = type_expression(*expression, scope_, found);
      if (typed && typed->dimension != wanted) {
        found.push_back(dimension_error(*expression, wanted, typed->dimension));
      }
    }
    const bool is_fine = found.empty();
    fail_expression(part, index, std::move(found));
    return is_fine ? std::move(expression) : std::nullopt;
  }

  // ---- equations ----
  void check_equations() {
    for (std::size_t i = 0; i < text_.equations.size(); ++i) {
      const std::string& key = text_.equations[i].name;
      const std::optional<std::string_view> integrated = derivative_of(key);
      // In "dv/dt" the state's name starts at the second letter.
      const std::string_view name = integrated.value_or(key);
      const std::uint32_t begin = integrated ? 1 : 0;
      const ExprSpan span{begin, begin + static_cast<std::uint32_t>(name.size())};
      const auto state = known_state(name, EquationPart::Equation, i, span);
      if (!state) {
        continue;
      }
      Dimension wanted = model_.states[*state].dimension;
      if (integrated) {
        wanted = divide(wanted, kTime).value_or(wanted);
        if (!check_only_one(*state, key, i)) {
          continue;
        }
      }
      if (auto value = checked(text_.equations[i].text, wanted, EquationPart::Equation, i)) {
        (integrated ? model_.derivatives : model_.updates).push_back({*state, i, std::move(*value)});
      }
    }
  }

  bool check_only_one(std::uint32_t state, const std::string& key, std::size_t index) {
    const auto is_same = [&](const EquationModel::Assignment& other) { return other.state == state; };
    if (std::none_of(model_.derivatives.begin(), model_.derivatives.end(), is_same)) {
      return true;
    }
    ExprError error{
        ExprErrorCode::UnknownName, whole(key), "a second equation for " + quoted(key), {}, std::nullopt, {}};
    fail(EquationErrorCode::DuplicateName, EquationPart::Equation, index, true, std::move(error));
    return false;
  }

  void check_threshold() {
    if (auto condition = checked(text_.threshold, kBoolean, EquationPart::Threshold, 0)) {
      model_.threshold = std::move(*condition);
    }
  }

  void check_resets() {
    for (std::size_t i = 0; i < text_.reset.size(); ++i) {
      const std::string& name = text_.reset[i].name;
      const auto state = known_state(name, EquationPart::Reset, i, whole(name));
      if (!state) {
        continue;
      }
      if (auto value = checked(text_.reset[i].text, model_.states[*state].dimension, EquationPart::Reset, i)) {
        model_.resets.push_back({*state, i, std::move(*value)});
      }
    }
  }

  void check_refractory() {
    if (text_.refractory.empty()) {
      return;
    }
    auto time = checked(text_.refractory, kTime, EquationPart::Refractory, 0);
    if (time && !uses_variables(*time, EquationPart::Refractory, 0)) {
      model_.refractory = std::move(*time);
    }
  }

  void check_hold() {
    if (text_.hold) {
      for (std::size_t i = 0; i < text_.hold->size(); ++i) {
        const std::string& name = (*text_.hold)[i];
        if (const auto state = known_state(name, EquationPart::Hold, i, whole(name))) {
          model_.hold_mask |= 1U << *state;
        }
      }
      return;
    }
    for (const NameUse& use : names_in(model_.threshold)) {
      if (const auto state = state_index(use.name)) {
        model_.hold_mask |= 1U << *state;
      }
    }
  }

  // ---- method ----
  void check_method() {
    model_.method = text_.method == EquationMethod::Unstated ? EquationMethod::Exact : text_.method;
    if (model_.method == EquationMethod::Euler) {
      return;
    }
    for (const EquationModel::Assignment& equation : model_.derivatives) {
      const std::string& own = model_.states[equation.state].name;
      const bool is_exact = model_.method == EquationMethod::Exact;
      // Exact: linear in all states and inputs at once. Exponential Euler: in its own state.
      const auto variable = [&](std::string_view name) -> std::optional<std::size_t> {
        const auto is_input = [&](const EquationInput& input) { return input.name == name; };
        const bool counts = is_exact ? state_index(name).has_value() ||
                                           std::any_of(model_.inputs.begin(), model_.inputs.end(), is_input)
                                     : name == own;
        return counts ? std::optional<std::size_t>(0) : std::nullopt;
      };
      const LinearSplit split = split_linear(equation.value, 1, variable);
      if (split.nonlinear) {
        fail_nonlinear(equation, own, *split.nonlinear);
      }
    }
  }

  void fail_nonlinear(const EquationModel::Assignment& equation, const std::string& own, ExprSpan span) {
    ExprError error{ExprErrorCode::NotConstant, span, {}, {}, std::nullopt, {}};
    EquationErrorCode code = EquationErrorCode::NotLinear;
    if (text_.method == EquationMethod::Unstated) {
      code = EquationErrorCode::MethodNeeded;
      error.message = "not linear in the states, so the equations cannot be integrated exactly";
      error.help = "name a method: `euler` or `exponential_euler`";
    } else if (model_.method == EquationMethod::Exact) {
      error.message = "not linear in the states, which exact integration needs";
      error.help = "use the method `euler` or `exponential_euler`";
    } else {
      error.message = "not linear in " + quoted(own) + ", which exponential Euler needs";
      error.help = "use the method `euler`";
    }
    fail(code, EquationPart::Equation, equation.index, false, std::move(error));
  }

  const EquationModelText& text_;
  std::vector<EquationError>& errors_;
  std::size_t first_error_;
  EquationModel model_;
  Environment scope_;
  std::vector<std::string> broken_parameters_;
};

}  // namespace

std::optional<Dimension> EquationModel::parameter_dimension(std::string_view name) const {
  for (const Parameter& parameter : parameters) {
    if (parameter.name == name) {
      return parameter.dimension;
    }
  }
  return std::nullopt;
}

std::optional<EquationModel> check_equation_model(const EquationModelText& text, const Environment& circuit,
                                                  std::vector<EquationError>& errors) {
  return Checker(text, circuit, errors).check();
}

}  // namespace tectum
