#include "compiler/expression/operand_checks.h"

#include <array>
#include <utility>

#include "compiler/expression/expression_text.h"

namespace tectum {

bool OperandChecks::number_argument(const FunctionInfo& function, const Operand& argument, Operand& result) {
  if (argument.dimension.is_number()) {
    return true;
  }
  fail(result, ExprErrorCode::NotANumber, argument.span,
       quoted(function.name) + " of " + describe(argument.dimension) + ", expected a number",
       "divide by a value in the same unit");
  return false;
}

bool OperandChecks::quantities(std::span<const Operand> operands, Operand& result) {
  for (const Operand& operand : operands) {
    if (operand.dimension.kind != Dimension::Kind::Quantity) {
      fail(result, ExprErrorCode::NotAQuantity, operand.span,
           "expected a quantity, found a " + describe(operand.dimension));
      return false;
    }
  }
  return true;
}

bool OperandChecks::truth_values(std::span<const Operand> operands, Operand& result) {
  for (const Operand& operand : operands) {
    if (operand.dimension != kBoolean) {
      fail(result, ExprErrorCode::NotATruthValue, operand.span,
           "expected a truth value, found " + describe(operand.dimension), "compare it with something");
    }
  }
  return !result.is_broken;
}

bool OperandChecks::all_same(const FunctionInfo& function, std::span<const Operand> operands, Operand& result) {
  for (std::size_t i = 1; i < operands.size(); ++i) {
    const std::array<Operand, 2> pair = {operands[0], operands[i]};
    if (!same(pair, quoted(function.name) + " mixes", result)) {
      return false;
    }
  }
  return true;
}

bool OperandChecks::same(std::span<const Operand> pair, std::string_view verb, Operand& result) {
  const Operand& a = pair[0];
  const Operand& b = pair[1];
  if (a.dimension == b.dimension) {
    return true;
  }
  std::string help;
  if (a.is_literal && b.dimension.kind == Dimension::Kind::Quantity) {
    help = with_unit(a, b.dimension);
  }
  if (b.is_literal && a.dimension.kind == Dimension::Kind::Quantity) {
    help = with_unit(b, a.dimension);
  }
  std::string message;
  if (verb == "adds") {
    message = "adds " + describe(b.dimension) + " to " + describe(a.dimension);
  } else if (verb == "subtracts") {
    message = "subtracts " + describe(b.dimension) + " from " + describe(a.dimension);
  } else {
    message = std::string(verb) + " " + describe(a.dimension) + " and " + describe(b.dimension);
  }
  fail(result, ExprErrorCode::DimensionMismatch, b.span, std::move(message), std::move(help), a.span,
       "this is " + describe(a.dimension));
  return false;
}

std::string OperandChecks::with_unit(const Operand& literal, const Dimension& wanted) const {
  const std::string unit = display_unit(wanted);
  const std::string number(expression_.text_of(literal.span));
  return unit.empty() ? "" : "write " + quoted(number + " " + unit);
}

void OperandChecks::fail(Operand& result, ExprErrorCode code, ExprSpan span, std::string message, std::string help,
                         std::optional<ExprSpan> other, std::string other_label) {
  result.is_broken = true;
  errors_.push_back({code, span, std::move(message), std::move(help), other, std::move(other_label)});
}

}  // namespace tectum
