// Names in scope, and the short way from text to a plain value.
#include <utility>

#include "compiler/expression/expression.h"
#include "compiler/expression/expression_text.h"

namespace tectum {

ExprError dimension_error(const Expression& expression, const Dimension& expected, const Dimension& found) {
  ExprError error;
  error.code = ExprErrorCode::DimensionMismatch;
  error.span = expression.nodes.back().span;
  error.message = "expected " + describe(expected) + ", found " + describe(found);
  const std::string unit = display_unit(expected);
  if (expression.nodes.back().op == ExprOp::Number && found.is_number() && !unit.empty()) {
    error.help = "write " + quoted(expression.text + " " + unit);
  }
  return error;
}

std::optional<Quantity> evaluate_constant(std::string_view text, const Environment& environment,
                                          std::vector<ExprError>& errors) {
  const std::optional<Expression> expression = parse_expression(text, errors);
  if (!expression) {
    return std::nullopt;
  }
  const std::optional<TypedExpression> typed = type_expression(*expression, environment, errors);
  if (!typed) {
    return std::nullopt;
  }
  if (typed->constant) {
    return Quantity{*typed->constant, typed->dimension};
  }
  for (const NameUse& use : names_in(*expression)) {
    const Symbol* symbol = environment.find(use.name);
    if (!symbol || !symbol->is_variable) {
      continue;
    }
    errors.push_back({ExprErrorCode::NotConstant,
                      use.span,
                      quoted(use.name) + " varies, and a constant is expected here",
                      {},
                      std::nullopt,
                      {}});
    break;
  }
  return std::nullopt;
}

void Environment::add_constant(std::string name, Quantity quantity) {
  symbols.insert_or_assign(std::move(name), Symbol{quantity.dimension, false, quantity.value, 0});
}

void Environment::add_word(std::string name, int value) {
  symbols.insert_or_assign(std::move(name), Symbol{kWord, false, static_cast<double>(value), 0});
}

void Environment::add_variable(std::string name, Dimension dimension, std::uint32_t slot) {
  symbols.insert_or_assign(std::move(name), Symbol{dimension, true, 0, slot});
}

const Symbol* Environment::find(std::string_view name) const {
  for (const Environment* scope = this; scope; scope = scope->outer) {
    const auto found = scope->symbols.find(name);
    if (found != scope->symbols.end()) {
      return &found->second;
    }
  }
  return nullptr;
}

}  // namespace tectum
