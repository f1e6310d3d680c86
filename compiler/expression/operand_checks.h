// What operators and functions ask of their operands' dimensions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/expression/expression.h"
#include "compiler/expression/functions.h"
#include "compiler/expression/step_list.h"

namespace tectum {

/// Each check reports what is wrong, marks `result` as broken and returns false.
class OperandChecks {
 public:
  explicit OperandChecks(const Expression& expression) : expression_(expression) {}

  bool number_argument(const FunctionInfo& function, const Operand& argument, Operand& result);
  bool quantities(std::span<const Operand> operands, Operand& result);
  bool truth_values(std::span<const Operand> operands, Operand& result);
  bool all_same(const FunctionInfo& function, std::span<const Operand> operands, Operand& result);
  /// `verb` completes the message: "adds", "subtracts", "compares", "`min` mixes".
  bool same(std::span<const Operand> pair, std::string_view verb, Operand& result);

  void fail(Operand& result, ExprErrorCode code, ExprSpan span, std::string message, std::string help = {},
            std::optional<ExprSpan> other = {}, std::string other_label = {});
  [[nodiscard]] std::vector<ExprError>& errors() { return errors_; }

 private:
  [[nodiscard]] std::string with_unit(const Operand& literal, const Dimension& wanted) const;

  const Expression& expression_;
  std::vector<ExprError> errors_;
};

}  // namespace tectum
