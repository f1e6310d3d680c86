#include "compiler/validate/slot_use.h"

#include <algorithm>

namespace tectum {

std::vector<std::uint32_t> slots_read(const TypedExpression& expression) {
  std::vector<std::uint32_t> slots;
  const auto add = [&](const EvalOperand& operand) {
    if (operand.kind == EvalOperand::Kind::Slot) {
      slots.push_back(operand.index);
    }
  };
  add(expression.result);
  for (const EvalInstruction& step : expression.program) {
    add(step.a);
    add(step.b);
    add(step.c);
  }
  std::sort(slots.begin(), slots.end());
  slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  return slots;
}

}  // namespace tectum
