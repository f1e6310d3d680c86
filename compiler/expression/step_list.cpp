#include "compiler/expression/step_list.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "compiler/expression/evaluate.h"

namespace tectum {
namespace {

void fold(EvalOp op, std::span<const Operand> operands, Operand& result) {
  double values[3] = {0, 0, 0};
  for (std::size_t i = 0; i < operands.size(); ++i) {
    values[i] = *operands[i].constant;
    if (!result.infinite) {
      result.infinite = operands[i].infinite;
    }
  }
  result.constant = apply_step(op, values[0], values[1], values[2]);
  if (!result.infinite && !std::isfinite(*result.constant)) {
    result.infinite = result.span;
  }
}

}  // namespace

Operand constant_operand(double value) {
  Operand operand;
  operand.constant = value;
  return operand;
}

void StepList::uses_slot(std::uint32_t slot) { typed_.slot_count = std::max(typed_.slot_count, slot + 1); }

void StepList::emit(EvalOp op, std::span<const Operand> operands, Operand& result) {
  const auto is_constant = [](const Operand& operand) { return operand.constant.has_value(); };
  if (std::all_of(operands.begin(), operands.end(), is_constant)) {
    fold(op, operands, result);
    return;
  }
  EvalInstruction step;
  step.op = op;
  step.a = place_of(operands[0]);
  step.b = operands.size() > 1 ? place_of(operands[1]) : step.a;
  step.c = operands.size() > 2 ? place_of(operands[2]) : step.a;
  step.target = target_;
  typed_.temporary_count = std::max(typed_.temporary_count, target_ + std::uint32_t{1});
  typed_.program.push_back(step);
  result.constant.reset();
  result.place = {EvalOperand::Kind::Temporary, target_};
}

void StepList::finish(const Operand& root) {
  typed_.dimension = root.dimension;
  typed_.constant = root.constant;
  typed_.result = place_of(root);
}

EvalOperand StepList::place_of(const Operand& operand) {
  if (!operand.constant) {
    return operand.place;
  }
  if (operand.infinite &&
      std::find(infinite_parts_.begin(), infinite_parts_.end(), *operand.infinite) == infinite_parts_.end()) {
    infinite_parts_.push_back(*operand.infinite);
  }
  // By bits, so that 0 and -0 stay apart.
  const auto same = [&](double c) {
    return std::bit_cast<std::uint64_t>(c) == std::bit_cast<std::uint64_t>(*operand.constant);
  };
  const auto found = std::find_if(typed_.constants.begin(), typed_.constants.end(), same);
  const auto index = static_cast<std::size_t>(found - typed_.constants.begin());
  if (found == typed_.constants.end()) {
    typed_.constants.push_back(*operand.constant);
  }
  return {EvalOperand::Kind::Constant, static_cast<std::uint16_t>(index)};
}

}  // namespace tectum
