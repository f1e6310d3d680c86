// The table of functions that an expression may call. The reference page is generated from it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/expression/expression.h"

namespace tectum {

/// How a function treats dimensions.
enum class FunctionRule : std::uint8_t {
  NumberToNumber,   // ln, exp: plain number in and out
  Keeps,            // abs: any quantity, same out
  AllSame,          // min, max, clamp, hypot, mod: all of one dimension, same out
  ToNumber,         // sign: any quantity, plain number out
  SquareRoot,       // sqrt: halves the exponents
  Power,            // pow: as the operator ^
  OfAngle,          // sin, cos, tan: an angle, or a plain number of radians
  ToAngle,          // asin, acos, atan: plain number in, angle out
  QuotientToAngle,  // atan2: two of one dimension in, angle out
  Conditional,      // if
};

struct FunctionInfo {
  std::string_view name;
  std::uint8_t least_arguments;
  std::uint8_t most_arguments;
  FunctionRule rule;
  EvalOp op;
  std::string_view about;
};

std::span<const FunctionInfo> expression_functions();
/// Every unit with the dimension it measures: "mV", "voltage (mV)".
std::vector<std::pair<std::string_view, std::string>> expression_units();
const FunctionInfo* find_function(std::string_view name);

}  // namespace tectum
