// The flat program of a typed expression while it grows, with constant parts folded on the way.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "compiler/expression/expression.h"

namespace tectum {

/// A value on the typing stack.
struct Operand {
  ExprSpan span;
  Dimension dimension;
  bool is_broken = false;   // had an error; silences what depends on it
  bool is_literal = false;  // a number without unit, as written
  std::optional<double> constant;
  std::optional<ExprSpan> infinite;  // constant: the part that first became infinite or NaN
  EvalOperand place;                 // when not constant
};

Operand constant_operand(double value);

class StepList {
 public:
  /// The temporary that the next steps write: the operand's place on the typing stack, so that no
  /// value that is still needed is overwritten.
  void set_target(std::size_t target) { target_ = static_cast<std::uint16_t>(target); }
  void uses_slot(std::uint32_t slot);

  /// Sets the value of `result` (not its dimension): folded, or one more step.
  void emit(EvalOp op, std::span<const Operand> operands, Operand& result);
  void finish(const Operand& root);

  /// Constant parts without a finite value whose value is needed.
  [[nodiscard]] const std::vector<ExprSpan>& infinite_parts() const { return infinite_parts_; }
  [[nodiscard]] TypedExpression take() { return std::move(typed_); }

 private:
  EvalOperand place_of(const Operand& operand);

  TypedExpression typed_;
  std::vector<ExprSpan> infinite_parts_;
  std::uint16_t target_ = 0;
};

}  // namespace tectum
