#include "compiler/expression/functions.h"

namespace tectum {
namespace {

constexpr auto kMany = static_cast<std::uint8_t>(kMaxArguments);

constexpr FunctionInfo kFunctions[] = {
    {"exp", 1, 1, FunctionRule::NumberToNumber, EvalOp::Exp, "e to the power of a number"},
    {"ln", 1, 1, FunctionRule::NumberToNumber, EvalOp::Log, "natural logarithm of a number"},
    {"log2", 1, 1, FunctionRule::NumberToNumber, EvalOp::Log2, "logarithm to base 2 of a number"},
    {"log10", 1, 1, FunctionRule::NumberToNumber, EvalOp::Log10, "logarithm to base 10 of a number"},
    {"sqrt", 1, 1, FunctionRule::SquareRoot, EvalOp::Sqrt, "square root; the unit's powers must be even"},
    {"min", 2, kMany, FunctionRule::AllSame, EvalOp::Min, "the smallest of two or more"},
    {"max", 2, kMany, FunctionRule::AllSame, EvalOp::Max, "the largest of two or more"},
    {"abs", 1, 1, FunctionRule::Keeps, EvalOp::Abs, "without its sign"},
    {"clamp", 3, 3, FunctionRule::AllSame, EvalOp::Max, "clamp(x, low, high): x, but at least low and at most high"},
    {"sin", 1, 1, FunctionRule::OfAngle, EvalOp::Sin, "sine of an angle, or of a number of radians"},
    {"cos", 1, 1, FunctionRule::OfAngle, EvalOp::Cos, "cosine of an angle, or of a number of radians"},
    {"tan", 1, 1, FunctionRule::OfAngle, EvalOp::Tan, "tangent of an angle, or of a number of radians"},
    {"asin", 1, 1, FunctionRule::ToAngle, EvalOp::Asin, "the angle with this sine"},
    {"acos", 1, 1, FunctionRule::ToAngle, EvalOp::Acos, "the angle with this cosine"},
    {"atan", 1, 1, FunctionRule::ToAngle, EvalOp::Atan, "the angle with this tangent"},
    {"atan2", 2, 2, FunctionRule::QuotientToAngle, EvalOp::Atan2, "atan2(y, x): the direction of the point (x, y)"},
    {"tanh", 1, 1, FunctionRule::NumberToNumber, EvalOp::Tanh, "hyperbolic tangent of a number"},
    {"hypot", 2, 2, FunctionRule::AllSame, EvalOp::Hypot, "length of the hypotenuse"},
    {"floor", 1, 1, FunctionRule::NumberToNumber, EvalOp::Floor, "the next whole number below"},
    {"ceil", 1, 1, FunctionRule::NumberToNumber, EvalOp::Ceil, "the next whole number above"},
    {"mod", 2, 2, FunctionRule::AllSame, EvalOp::Mod, "remainder, with the sign of the divisor"},
    {"sign", 1, 1, FunctionRule::ToNumber, EvalOp::Sign, "-1, 0 or 1"},
    {"pow", 2, 2, FunctionRule::Power, EvalOp::Power, "pow(a, b) is a ^ b"},
    {"if", 3, 3, FunctionRule::Conditional, EvalOp::Select, "if(condition, a, b) is condition ? a : b"},
};

}  // namespace

std::span<const FunctionInfo> expression_functions() { return kFunctions; }

const FunctionInfo* find_function(std::string_view name) {
  for (const FunctionInfo& function : kFunctions) {
    if (function.name == name) {
      return &function;
    }
  }
  return nullptr;
}

}  // namespace tectum
