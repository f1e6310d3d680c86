// EquationModel + values → EquationProgram.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "compiler/expression/equation_model.h"
#include "compiler/expression/equation_scope.h"
#include "compiler/expression/expression_text.h"
#include "compiler/expression/linear_split.h"
#include "compiler/expression/matrix_exponential.h"
#include "compiler/expression/program_builder.h"

namespace tectum {
namespace {

constexpr double kMaxRefractoryTicks = 65535;  // as the built-in models

// One value for all neurons, or one a neuron.
using Values = std::vector<double>;
double value_at(const Values& values, std::size_t i) { return values.size() == 1 ? values[0] : values[i]; }
bool is_zero(const Values& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
}
void collapse(Values& values) {
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; })) {
    values.resize(1);
  }
}

class EquationCompiler {
 public:
  EquationCompiler(const EquationModel& model, BoundParameters bound, std::uint32_t size,
                   std::vector<EquationError>& errors)
      : model_(model),
        bound_(std::move(bound)),
        size_(size),
        errors_(errors),
        scope_(equation_scope(model, bound_)),
        builder_(static_cast<std::uint32_t>(model.states.size()), static_cast<std::uint32_t>(model.inputs.size())) {
    for (std::uint32_t s = 0; s < model.states.size(); ++s) {
      slots_.push_back(ProgramBuilder::state(s));
    }
    for (std::uint32_t r = 0; r < model.inputs.size(); ++r) {
      slots_.push_back(ProgramBuilder::input(r));
    }
    slots_.resize(slots_.size() + model.parameters.size());  // columns: bound when first read
  }

  std::optional<EquationProgram> compile() {
    const std::size_t first_error = errors_.size();
    builder_.begin(ProgramPart::Update);
    append_derivatives();
    append_assignments(model_.updates, EquationPart::Equation);
    builder_.begin(ProgramPart::Threshold);
    const ProgramPlace fires = append(model_.threshold, EquationPart::Threshold, 0);
    builder_.begin(ProgramPart::Reset);
    append_assignments(model_.resets, EquationPart::Reset);
    std::vector<ProgramPlace> initial;
    for (std::size_t s = 0; s < model_.states.size(); ++s) {
      initial.push_back(builder_.values(values_of(model_.states[s].initial, EquationPart::State, s)));
    }
    const std::uint32_t refractory_ticks = compile_refractory();
    if (errors_.size() > first_error) {
      return std::nullopt;
    }
    EquationProgram program;
    program.words = builder_.words(fires, initial, refractory_ticks, model_.hold_mask);
    program.constants = builder_.constants();
    program.columns = std::move(builder_.columns());
    return program;
  }

 private:
  // ---- expressions ----
  std::optional<TypedExpression> typed(const Expression& expression, EquationPart part, std::size_t index) {
    std::vector<ExprError> found;
    auto result = type_expression(expression, scope_, found);
    for (ExprError& error : found) {
      errors_.push_back({EquationErrorCode::Expression, part, index, false, std::move(error)});
    }
    return result;
  }

  ProgramPlace append(const Expression& expression, EquationPart part, std::size_t index) {
    const auto result = typed(expression, part, index);
    return result ? append(*result) : ProgramPlace{};
  }

  ProgramPlace append(const TypedExpression& expression) {
    const auto bind = [&](EvalOperand operand) {
      const std::uint32_t first_parameter = parameter_slot(model_, 0);
      if (operand.kind == EvalOperand::Kind::Slot && operand.index >= first_parameter) {
        slots_[operand.index] = builder_.column(bound_.values[operand.index - first_parameter]);
      }
    };
    bind(expression.result);
    for (const EvalInstruction& step : expression.program) {
      bind(step.a);
      bind(step.b);
      bind(step.c);
    }
    return append_expression(expression, slots_, builder_);
  }

  // Of an expression over parameters only.
  Values values_of(const Expression& expression, EquationPart part, std::size_t index) {
    const auto result = typed(expression, part, index);
    if (!result) {
      return {0};
    }
    Values values = parameter_expression_values(model_, bound_, *result, size_);
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
      const ExprSpan all{0, static_cast<std::uint32_t>(expression.text.size())};
      fail(EquationErrorCode::Expression, part, index, ExprErrorCode::NotFinite, all,
           "has no finite value for some neuron");
    }
    collapse(values);
    return values;
  }

  void fail(EquationErrorCode code, EquationPart part, std::size_t index, ExprErrorCode kind, ExprSpan span,
            std::string message) {
    errors_.push_back({code, part, index, false, {kind, span, std::move(message), {}, std::nullopt, {}}});
  }

  void append_assignments(const std::vector<EquationModel::Assignment>& assignments, EquationPart part) {
    for (const EquationModel::Assignment& assignment : assignments) {
      const std::uint32_t mark = builder_.temporaries_in_use();
      builder_.assign(ProgramBuilder::state(assignment.state), append(assignment.value, part, assignment.index));
      builder_.release(mark);
    }
  }

  // ---- derivatives: all see the old states, so new values wait in temporaries where one is still read ----
  void append_derivatives() {
    if (model_.method == EquationMethod::Exact) {
      find_propagators();
    }
    std::vector<std::pair<ProgramPlace, ProgramPlace>> waiting;  // (state, its new value)
    for (std::size_t d = 0; d < model_.derivatives.size(); ++d) {
      const ProgramPlace state = ProgramBuilder::state(model_.derivatives[d].state);
      const std::uint32_t mark = builder_.temporaries_in_use();
      const ProgramPlace target = is_read_later(d) ? builder_.new_temporary() : state;
      const std::uint32_t keep = builder_.temporaries_in_use();
      if (model_.method == EquationMethod::Exact) {
        append_exact(d, target);
      } else {
        append_step(d, state, target);
      }
      builder_.release(target == state ? mark : keep);
      if (!(target == state)) {
        waiting.emplace_back(state, target);
      }
    }
    for (const auto& [state, value] : waiting) {
      builder_.emit(ProgramOp::Copy, state, value);
    }
    builder_.release(0);
  }

  [[nodiscard]] bool is_read_later(std::size_t d) const {
    const std::string& name = model_.states[model_.derivatives[d].state].name;
    for (std::size_t later = d + 1; later < model_.derivatives.size(); ++later) {
      for (const NameUse& use : names_in(model_.derivatives[later].value)) {
        if (use.name == name) {
          return true;
        }
      }
    }
    return false;
  }

  // x + g f with g = h (Euler), or h phi(h a) for dx/dt = a x + b (exponential Euler, which is exact for
  // constant a and b). Hochbruck & Ostermann 2010, doi:10.1017/S0962492910000048.
  void append_step(std::size_t d, ProgramPlace state, ProgramPlace target) {
    const EquationModel::Assignment& equation = model_.derivatives[d];
    const ProgramPlace f = append(equation.value, EquationPart::Equation, equation.index);
    ProgramPlace gain = builder_.constant(bound_.tick_ms);
    if (model_.method == EquationMethod::ExponentialEuler) {
      const std::string& own = model_.states[equation.state].name;
      const LinearSplit split = split_linear(equation.value, 1, [&](std::string_view name) {
        return name == own ? std::optional<std::size_t>(0) : std::nullopt;
      });
      assert(!split.nonlinear && "checked with the model");
      if (split.slopes[0]) {
        gain = append_gain(*split.slopes[0], equation.index);
      }
    }
    builder_.emit(ProgramOp::MultiplyAdd, target, gain, f, state);
  }

  ProgramPlace append_gain(const Expression& slope, std::size_t index) {
    const auto rate = typed(slope, EquationPart::Equation, index);
    if (!rate) {
      return {};
    }
    const double h = bound_.tick_ms;
    if (rate->constant) {
      const double z = h * *rate->constant;
      return builder_.constant(z == 0 ? h : h * (std::expm1(z) / z));
    }
    const ProgramPlace a = append(*rate);
    const ProgramPlace gain = builder_.new_temporary();
    builder_.emit(ProgramOp::Multiply, gain, a, builder_.constant(h));
    builder_.emit(ProgramOp::ExpRatio, gain, gain);
    builder_.emit(ProgramOp::Multiply, gain, gain, builder_.constant(h));
    return gain;
  }

  // ---- exact integration: dx/dt = A x + B u + c  →  x P + R (B u + c), see matrix_exponential.h ----
  struct LinearRow {
    std::vector<Values> slopes;  // of the states, then the inputs
    Values offset;
  };

  void find_propagators() {
    const std::size_t state_count = model_.states.size();
    const std::size_t variable_count = state_count + model_.inputs.size();
    rows_.assign(state_count, LinearRow{std::vector<Values>(variable_count, Values{0}), Values{0}});
    const auto variable_of = [&](std::string_view name) -> std::optional<std::size_t> {
      const Symbol* symbol = scope_.find(name);
      return symbol && symbol->is_variable && symbol->slot < variable_count ? std::optional<std::size_t>(symbol->slot)
                                                                            : std::nullopt;
    };
    for (const EquationModel::Assignment& equation : model_.derivatives) {
      const LinearSplit split = split_linear(equation.value, variable_count, variable_of);
      assert(!split.nonlinear && "checked with the model");
      LinearRow& row = rows_[equation.state];
      for (std::size_t v = 0; v < variable_count; ++v) {
        if (split.slopes[v]) {
          row.slopes[v] = values_of(*split.slopes[v], EquationPart::Equation, equation.index);
        }
      }
      if (split.offset) {
        row.offset = values_of(*split.offset, EquationPart::Equation, equation.index);
      }
    }
    integrate_rows();
    check_finite();
  }

  void integrate_rows() {
    const std::size_t n = model_.states.size();
    bool varies = false;
    for (const LinearRow& row : rows_) {
      for (std::size_t j = 0; j < n; ++j) {
        varies = varies || row.slopes[j].size() > 1;
      }
    }
    const std::size_t count = varies ? size_ : 1;
    std::vector<Propagators> steps;
    for (std::size_t i = 0; i < count; ++i) {
      SquareMatrix a(n);
      for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t j = 0; j < n; ++j) {
          a.at(r, j) = value_at(rows_[r].slopes[j], i);
        }
      }
      steps.push_back(propagators(a, bound_.tick_ms));
    }
    propagated_.assign(n, LinearRow{});
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t j = 0; j < n; ++j) {
        Values values;
        for (const Propagators& step : steps) {
          values.push_back(step.state.at(r, j));
        }
        collapse(values);
        propagated_[r].slopes.push_back(std::move(values));
      }
      for (std::size_t k = n; k < rows_[r].slopes.size(); ++k) {
        propagated_[r].slopes.push_back(
            integrated(steps, r, [&](std::size_t j) -> const Values& { return rows_[j].slopes[k]; }));
      }
      propagated_[r].offset = integrated(steps, r, [&](std::size_t j) -> const Values& { return rows_[j].offset; });
    }
  }

  // Row r of R times the vector of values that `of` gives for each state.
  template <typename Of>
  Values integrated(const std::vector<Propagators>& steps, std::size_t r, Of of) {
    bool varies = steps.size() > 1;
    for (std::size_t j = 0; j < model_.states.size(); ++j) {
      varies = varies || of(j).size() > 1;
    }
    Values result;
    for (std::size_t i = 0; i < (varies ? size_ : 1); ++i) {
      const Propagators& step = steps.size() == 1 ? steps[0] : steps[i];
      double sum = 0;
      for (std::size_t j = 0; j < model_.states.size(); ++j) {
        sum += step.input.at(r, j) * value_at(of(j), i);
      }
      result.push_back(sum);
    }
    collapse(result);
    return result;
  }

  void append_exact(std::size_t d, ProgramPlace target) {
    const EquationModel::Assignment& equation = model_.derivatives[d];
    const LinearRow& row = propagated_[equation.state];
    // The own state last: target may be that state, and no term after it reads it.
    std::vector<std::size_t> order;
    for (std::size_t v = 0; v < row.slopes.size(); ++v) {
      if (v != equation.state && !is_zero(row.slopes[v])) {
        order.push_back(v);
      }
    }
    order.push_back(equation.state);
    const ProgramPlace sum = order.size() > 1 ? builder_.new_temporary() : target;
    ProgramPlace so_far = builder_.values(row.offset);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const ProgramPlace to = k + 1 == order.size() ? target : sum;
      const ProgramPlace factor = builder_.values(row.slopes[order[k]]);
      if (k == 0 && is_zero(row.offset)) {
        builder_.emit(ProgramOp::Multiply, to, factor, slots_[order[k]]);
      } else {
        builder_.emit(ProgramOp::MultiplyAdd, to, factor, slots_[order[k]], so_far);
      }
      so_far = to;
    }
  }

  // One row without bound spoils those that depend on it, so only the fastest growing one is reported.
  void check_finite() {
    const auto is_finite = [](const Values& values) {
      return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    };
    const bool is_fine = std::all_of(propagated_.begin(), propagated_.end(), [&](const LinearRow& row) {
      return is_finite(row.offset) && std::all_of(row.slopes.begin(), row.slopes.end(), is_finite);
    });
    if (is_fine) {
      return;
    }
    const auto growth = [&](const EquationModel::Assignment& equation) {
      const Values& own = rows_[equation.state].slopes[equation.state];
      return *std::max_element(own.begin(), own.end());
    };
    const auto fastest = std::max_element(model_.derivatives.begin(), model_.derivatives.end(),
                                          [&](const auto& a, const auto& b) { return growth(a) < growth(b); });
    const ExprSpan all{0, static_cast<std::uint32_t>(fastest->value.text.size())};
    fail(EquationErrorCode::Expression, EquationPart::Equation, fastest->index, ExprErrorCode::NotFinite, all,
         "grows beyond the range of numbers within one tick");
  }

  std::uint32_t compile_refractory() {
    if (!model_.refractory) {
      return 0;
    }
    const Values time_ms = values_of(*model_.refractory, EquationPart::Refractory, 0);
    const ExprSpan all{0, static_cast<std::uint32_t>(model_.refractory->text.size())};
    const double ticks = time_ms[0] / bound_.tick_ms;
    const double whole = std::round(ticks);
    const bool is_whole = std::abs(ticks - whole) <= 1e-6 * std::max(1.0, std::abs(ticks));
    if (time_ms.size() > 1) {
      fail(EquationErrorCode::NotConstant, EquationPart::Refractory, 0, ExprErrorCode::NotConstant, all,
           "refractory time differs from neuron to neuron");
    } else if (!is_whole || whole < 0 || whole > kMaxRefractoryTicks) {
      fail(EquationErrorCode::NotWholeTicks, EquationPart::Refractory, 0, ExprErrorCode::NotANumber, all,
           "refractory time is " + format_quantity({time_ms[0], kTime}) + ", expected a whole number of ticks of " +
               format_quantity({bound_.tick_ms, kTime}) + " up to 65535");
    } else {
      return static_cast<std::uint32_t>(whole);
    }
    return 0;
  }

  const EquationModel& model_;
  BoundParameters bound_;
  std::uint32_t size_;
  std::vector<EquationError>& errors_;
  Environment scope_;
  ProgramBuilder builder_;
  std::vector<ProgramPlace> slots_;
  std::vector<LinearRow> rows_;        // A, B, c by state
  std::vector<LinearRow> propagated_;  // P, R B, R c by state
};

}  // namespace

std::optional<EquationProgram> compile_equations(const EquationModel& model, const EquationParameterValues& values,
                                                 std::uint32_t size, double tick_ms,
                                                 std::vector<EquationError>& errors) {
  auto bound = bind_parameters(model, values, size, tick_ms, errors);
  if (!bound) {
    return std::nullopt;
  }
  return EquationCompiler(model, std::move(*bound), size, errors).compile();
}

}  // namespace tectum
