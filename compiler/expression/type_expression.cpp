// Expression + Environment → TypedExpression: one pass over the flat post-order with a stack of
// operands, so that no depth of nesting recurses. An operand that had an error is `broken` and
// silences everything that depends on it.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "compiler/expression/expression.h"
#include "compiler/expression/expression_text.h"
#include "compiler/expression/functions.h"
#include "compiler/expression/operand_checks.h"
#include "compiler/expression/step_list.h"

namespace tectum {
namespace {

std::string_view operator_verb(ExprOp op) {
  switch (op) {
    case ExprOp::Add:
      return "adds";
    case ExprOp::Subtract:
      return "subtracts";
    default:
      return "compares";
  }
}

EvalOp plain_op(ExprOp op) {
  switch (op) {
    case ExprOp::Negate:
      return EvalOp::Negate;
    case ExprOp::Not:
      return EvalOp::Not;
    case ExprOp::Add:
      return EvalOp::Add;
    case ExprOp::Subtract:
      return EvalOp::Subtract;
    case ExprOp::Multiply:
      return EvalOp::Multiply;
    case ExprOp::Divide:
      return EvalOp::Divide;
    case ExprOp::Power:
      return EvalOp::Power;
    case ExprOp::Equal:
      return EvalOp::Equal;
    case ExprOp::NotEqual:
      return EvalOp::NotEqual;
    case ExprOp::Less:
    case ExprOp::Greater:
      return EvalOp::Less;
    case ExprOp::LessEqual:
    case ExprOp::GreaterEqual:
      return EvalOp::LessEqual;
    case ExprOp::And:
      return EvalOp::And;
    case ExprOp::Or:
      return EvalOp::Or;
    default:
      return EvalOp::Select;
  }
}

class Typer {
 public:
  Typer(const Expression& expression, const Environment& environment)
      : expression_(expression), environment_(environment), checks_(expression) {}

  std::optional<TypedExpression> type(std::vector<ExprError>& errors) {
    for (const ExprNode& node : expression_.nodes) {
      visit(node);
    }
    assert(stack_.size() == 1);
    Operand& root = stack_.back();
    if (!root.is_broken) {
      steps_.finish(root);
    }
    for (const ExprSpan part : steps_.infinite_parts()) {
      const std::string text = quoted(expression_.text_of(part));
      checks_.errors().push_back({ExprErrorCode::NotFinite, part, text + " has no finite value", {}, std::nullopt, {}});
    }
    std::vector<ExprError>& found = checks_.errors();
    if (found.empty()) {
      return steps_.take();
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const ExprError& a, const ExprError& b) { return a.span.begin < b.span.begin; });
    errors.insert(errors.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
    return std::nullopt;
  }

 private:
  void visit(const ExprNode& node) {
    const std::size_t first = stack_.size() - node.operand_count;
    const std::span<Operand> operands(stack_.data() + first, node.operand_count);
    Operand result;
    result.span = node.span;
    steps_.set_target(first);  // results go to the temporary of their place on the stack
    const bool is_broken = std::any_of(operands.begin(), operands.end(), [](const Operand& o) { return o.is_broken; });
    if (node.op == ExprOp::Number) {
      number(node, result);
    } else if (node.op == ExprOp::Name) {
      name(node, result);
    } else if (node.op == ExprOp::Call) {
      call(node, operands, is_broken, result);
    } else if (is_broken) {
      result.is_broken = true;
    } else {
      operation(node, operands, result);
    }
    stack_.resize(first);
    stack_.push_back(result);
  }

  // ---- leaves ----
  void number(const ExprNode& node, Operand& result) {
    result.dimension = node.dimension;
    result.constant = node.value;
    result.is_literal = node.unit.end == 0;
    // The parser took everything after the first unit name as part of the unit without knowing the
    // names of the circuit.
    const std::string_view unit = expression_.text_of(node.unit);
    for (std::size_t i = unit.find_first_of("*/"); i < unit.size(); i = unit.find_first_of("*/", i)) {
      ++i;
      const std::size_t end = std::min(unit.find_first_of("*/^", i), unit.size());
      if (!environment_.find(unit.substr(i, end - i))) {
        continue;
      }
      const auto begin = static_cast<std::uint32_t>(node.unit.begin + i);
      checks_.fail(result, ExprErrorCode::AmbiguousUnit, {begin, static_cast<std::uint32_t>(node.unit.begin + end)},
                   quoted(unit.substr(i, end - i)) + " is both a unit and a name here",
                   "blanks around the operator make it the name, brackets around number and unit make it the unit");
      return;
    }
  }

  void name(const ExprNode& node, Operand& result) {
    const std::string_view text = expression_.text_of(node.token);
    if (const Symbol* symbol = environment_.find(text)) {
      result.dimension = symbol->dimension;
      if (!symbol->is_variable) {
        result.constant = symbol->value;
        return;
      }
      assert(symbol->slot <= std::numeric_limits<std::uint16_t>::max());
      result.place = {EvalOperand::Kind::Slot, static_cast<std::uint16_t>(symbol->slot)};
      steps_.uses_slot(symbol->slot);
    } else if (text == "pi") {
      result.constant = std::numbers::pi;
    } else if (text == "true" || text == "false") {
      result.dimension = kBoolean;
      result.constant = text == "true" ? 1 : 0;
    } else if (const std::optional<Unit> unit = find_unit(text)) {
      result.dimension = unit->dimension;
      result.constant = to_coherent(1, *unit);
    } else {
      const std::optional<std::string> nearest = nearest_name(text, names_in_scope());
      std::string help = nearest ? "did you mean " + quoted(*nearest) + "?" : "";
      if (find_function(text)) {
        help = quoted(text) + " is a function: its arguments go in brackets";
      }
      checks_.fail(result, ExprErrorCode::UnknownName, node.token, "unknown name " + quoted(text), std::move(help));
    }
  }

  std::vector<std::string> names_in_scope() const {
    std::vector<std::string> names;
    for (const Environment* scope = &environment_; scope; scope = scope->outer) {
      for (const auto& [name, symbol] : scope->symbols) {
        names.push_back(name);
      }
    }
    return names;
  }

  // ---- operators ----
  void operation(const ExprNode& node, std::span<Operand> operands, Operand& result) {
    switch (node.op) {
      case ExprOp::Negate:
        if (checks_.quantities(operands, result)) {
          result.dimension = operands[0].dimension;
          steps_.emit(EvalOp::Negate, operands, result);
        }
        return;
      case ExprOp::Add:
      case ExprOp::Subtract:
        if (checks_.quantities(operands, result) && checks_.same(operands, operator_verb(node.op), result)) {
          result.dimension = operands[0].dimension;
          steps_.emit(plain_op(node.op), operands, result);
        }
        return;
      case ExprOp::Multiply:
      case ExprOp::Divide:
        product(node, operands, result);
        return;
      case ExprOp::Power:
        raise(operands, result);
        return;
      case ExprOp::And:
      case ExprOp::Or:
      case ExprOp::Not:
        result.dimension = kBoolean;
        if (checks_.truth_values(operands, result)) {
          steps_.emit(plain_op(node.op), operands, result);
        }
        return;
      case ExprOp::If:
        choose(operands, result);
        return;
      default:
        compare(node, operands, result);
        return;
    }
  }

  void product(const ExprNode& node, std::span<Operand> operands, Operand& result) {
    if (!checks_.quantities(operands, result)) {
      return;
    }
    const Dimension& a = operands[0].dimension;
    const Dimension& b = operands[1].dimension;
    const std::optional<Dimension> dimension = node.op == ExprOp::Multiply ? multiply(a, b) : divide(a, b);
    if (!dimension) {
      checks_.fail(result, ExprErrorCode::BadPower, node.span, "powers of the unit are too large");
      return;
    }
    result.dimension = *dimension;
    steps_.emit(plain_op(node.op), operands, result);
  }

  void compare(const ExprNode& node, std::span<Operand> operands, Operand& result) {
    result.dimension = kBoolean;
    const bool is_ordering = node.op != ExprOp::Equal && node.op != ExprOp::NotEqual;
    if (is_ordering && !checks_.quantities(operands, result)) {
      return;
    }
    if (!checks_.same(operands, "compares", result)) {
      return;
    }
    if (node.op == ExprOp::Greater || node.op == ExprOp::GreaterEqual) {
      std::swap(operands[0], operands[1]);
    }
    steps_.emit(plain_op(node.op), operands, result);
  }

  void choose(std::span<Operand> operands, Operand& result) {
    if (!checks_.truth_values(operands.first(1), result)) {
      return;
    }
    if (!checks_.same(operands.subspan(1), "chooses between", result)) {
      return;
    }
    result.dimension = operands[1].dimension;
    if (!operands[0].constant) {
      steps_.emit(EvalOp::Select, operands, result);
      return;
    }
    // Only the chosen side counts, so "if(n > 0, 1 / n, 0)" is fine for n = 0.
    Operand& chosen = *operands[0].constant != 0 ? operands[1] : operands[2];
    if (chosen.constant || chosen.place.kind == EvalOperand::Kind::Slot) {
      result.constant = chosen.constant;
      result.infinite = chosen.infinite;
      result.place = chosen.place;
    } else {
      // Moves the value down to the temporary of this place on the stack.
      std::array<Operand, 3> both = {operands[0], chosen, chosen};
      steps_.emit(EvalOp::Select, both, result);
    }
  }

  void raise(std::span<Operand> operands, Operand& result) {
    if (!checks_.quantities(operands, result)) {
      return;
    }
    const Operand& base = operands[0];
    const Operand& exponent = operands[1];
    if (!exponent.dimension.is_number()) {
      checks_.fail(result, ExprErrorCode::NotANumber, exponent.span,
                   "exponent is " + describe(exponent.dimension) + ", expected a number");
      return;
    }
    if (!base.dimension.is_number()) {
      if (!exponent.constant) {
        checks_.fail(result, ExprErrorCode::BadPower, exponent.span,
                     "base is " + describe(base.dimension) + ", so the exponent must be a constant", {}, base.span,
                     "this has a unit");
        return;
      }
      const std::optional<Dimension> dimension = fractional_power(base.dimension, *exponent.constant);
      if (!dimension) {
        checks_.fail(result, ExprErrorCode::BadPower, exponent.span,
                     describe(base.dimension) + " to this power has no whole powers of its units", {}, base.span,
                     "this is " + describe(base.dimension));
        return;
      }
      result.dimension = *dimension;
    }
    steps_.emit(EvalOp::Power, operands, result);
  }

  static std::optional<Dimension> fractional_power(const Dimension& base, double exponent) {
    Dimension result;
    for (std::size_t i = 0; i < kBaseDimensionCount; ++i) {
      const double raised = base.exponents[i] * exponent;
      if (!(std::abs(raised) <= 100) || raised != std::floor(raised)) {
        return std::nullopt;
      }
      result.exponents[i] = static_cast<std::int8_t>(raised);
    }
    return result;
  }

  // ---- functions ----
  void call(const ExprNode& node, std::span<Operand> operands, bool is_broken, Operand& result) {
    const std::string_view name = expression_.text_of(node.token);
    const FunctionInfo* function = find_function(name);
    if (!function) {
      unknown_function(node, name, result);
      return;
    }
    if (operands.size() < function->least_arguments || operands.size() > function->most_arguments) {
      checks_.fail(result, ExprErrorCode::WrongArity, node.span,
                   quoted(name) + " takes " + arity_text(*function) + ", found " + std::to_string(operands.size()),
                   std::string(function->about));
      return;
    }
    result.is_broken = is_broken;
    if (is_broken || !checks_.quantities(operands, result)) {
      return;
    }
    apply(*function, operands, result);
  }

  void unknown_function(const ExprNode& node, std::string_view name, Operand& result) {
    std::vector<std::string> names;
    for (const FunctionInfo& known : expression_functions()) {
      names.emplace_back(known.name);
    }
    const std::optional<std::string> nearest = nearest_name(name, names);
    std::string help = nearest ? "did you mean " + quoted(*nearest) + "?" : "";
    if (name == "log") {
      help = "natural logarithm is `ln`, to other bases `log2` and `log10`";
    }
    if (environment_.find(name)) {
      help = quoted(name) + " is a value; to multiply, write `*`";
    }
    checks_.fail(result, ExprErrorCode::UnknownFunction, node.token, "unknown function " + quoted(name),
                 std::move(help));
  }

  static std::string arity_text(const FunctionInfo& function) {
    const unsigned least = function.least_arguments;
    const std::string count = std::to_string(least) + (least == 1 ? " argument" : " arguments");
    return function.most_arguments > least ? std::to_string(least) + " or more arguments" : count;
  }

  void apply(const FunctionInfo& function, std::span<Operand> operands, Operand& result) {
    result.dimension = operands[0].dimension;
    switch (function.rule) {
      case FunctionRule::NumberToNumber:
        if (checks_.number_argument(function, operands[0], result)) {
          steps_.emit(function.op, operands, result);
        }
        return;
      case FunctionRule::Keeps:
        steps_.emit(function.op, operands, result);
        return;
      case FunctionRule::AllSame:
        if (checks_.all_same(function, operands, result)) {
          fold_arguments(function, operands, result);
        }
        return;
      case FunctionRule::ToNumber:
        result.dimension = kNumber;
        steps_.emit(function.op, operands, result);
        return;
      case FunctionRule::SquareRoot:
        square_root(operands, result);
        return;
      case FunctionRule::Power:
        raise(operands, result);
        return;
      case FunctionRule::OfAngle:
        of_angle(function, operands, result);
        return;
      case FunctionRule::ToAngle:
        if (checks_.number_argument(function, operands[0], result)) {
          to_degrees(function.op, operands, result);
        }
        return;
      case FunctionRule::QuotientToAngle:
        if (checks_.all_same(function, operands, result)) {
          to_degrees(function.op, operands, result);
        }
        return;
      case FunctionRule::Conditional:
        assert(false && "the parser makes if(...) an If node");
        return;
    }
  }

  void square_root(std::span<Operand> operands, Operand& result) {
    const std::optional<Dimension> dimension = root(operands[0].dimension, 2);
    if (!dimension) {
      checks_.fail(result, ExprErrorCode::BadPower, operands[0].span,
                   "square root of " + describe(operands[0].dimension) + " has no whole powers of its units");
      return;
    }
    result.dimension = *dimension;
    steps_.emit(EvalOp::Sqrt, operands, result);
  }

  void of_angle(const FunctionInfo& function, std::span<Operand> operands, Operand& result) {
    Operand argument = operands[0];
    if (argument.dimension == kAngle) {
      Operand radians;
      std::array<Operand, 2> factors = {argument, constant_operand(std::numbers::pi / 180.0)};
      steps_.emit(EvalOp::Multiply, factors, radians);
      argument = radians;
    } else if (!argument.dimension.is_number()) {
      checks_.fail(result, ExprErrorCode::NotANumber, argument.span,
                   quoted(function.name) + " of " + describe(argument.dimension) + ", expected an angle");
      return;
    }
    result.dimension = kNumber;
    std::array<Operand, 1> radians = {argument};
    steps_.emit(function.op, radians, result);
  }

  void to_degrees(EvalOp op, std::span<Operand> operands, Operand& result) {
    Operand radians;
    radians.span = result.span;
    steps_.emit(op, operands, radians);
    result.dimension = kAngle;
    std::array<Operand, 2> factors = {radians, constant_operand(180.0 / std::numbers::pi)};
    steps_.emit(EvalOp::Multiply, factors, result);
  }

  void fold_arguments(const FunctionInfo& function, std::span<Operand> operands, Operand& result) {
    const bool is_clamp = function.name == "clamp";
    Operand so_far = operands[0];
    for (std::size_t i = 1; i < operands.size(); ++i) {
      Operand next;
      next.span = result.span;
      std::array<Operand, 2> pair = {so_far, operands[i]};
      steps_.emit(is_clamp && i == 2 ? EvalOp::Min : function.op, pair, next);
      so_far = next;
    }
    so_far.dimension = result.dimension;
    so_far.span = result.span;
    result = so_far;
  }

  const Expression& expression_;
  const Environment& environment_;
  std::vector<Operand> stack_;
  OperandChecks checks_;
  StepList steps_;
};

}  // namespace

std::optional<TypedExpression> type_expression(const Expression& expression, const Environment& environment,
                                               std::vector<ExprError>& errors) {
  return Typer(expression, environment).type(errors);
}

}  // namespace tectum
