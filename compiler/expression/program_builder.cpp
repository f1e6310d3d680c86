#include "compiler/expression/program_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <optional>
#include <utility>

namespace tectum {
namespace {

ProgramOp program_op(EvalOp op) {
  switch (op) {
    case EvalOp::Negate:
      return ProgramOp::Negate;
    case EvalOp::Not:
      return ProgramOp::Not;
    case EvalOp::Add:
      return ProgramOp::Add;
    case EvalOp::Subtract:
      return ProgramOp::Subtract;
    case EvalOp::Multiply:
      return ProgramOp::Multiply;
    case EvalOp::Divide:
      return ProgramOp::Divide;
    case EvalOp::Power:
      return ProgramOp::Power;
    case EvalOp::Equal:
      return ProgramOp::Equal;
    case EvalOp::NotEqual:
      return ProgramOp::NotEqual;
    case EvalOp::Less:
      return ProgramOp::Less;
    case EvalOp::LessEqual:
      return ProgramOp::LessEqual;
    case EvalOp::And:
      return ProgramOp::And;
    case EvalOp::Or:
      return ProgramOp::Or;
    case EvalOp::Select:
      return ProgramOp::Select;
    case EvalOp::Exp:
      return ProgramOp::Exp;
    case EvalOp::Log:
      return ProgramOp::Log;
    case EvalOp::Log2:
      return ProgramOp::Log2;
    case EvalOp::Log10:
      return ProgramOp::Log10;
    case EvalOp::Sqrt:
      return ProgramOp::Sqrt;
    case EvalOp::Abs:
      return ProgramOp::Abs;
    case EvalOp::Floor:
      return ProgramOp::Floor;
    case EvalOp::Ceil:
      return ProgramOp::Ceil;
    case EvalOp::Sign:
      return ProgramOp::Sign;
    case EvalOp::Sin:
      return ProgramOp::Sin;
    case EvalOp::Cos:
      return ProgramOp::Cos;
    case EvalOp::Tan:
      return ProgramOp::Tan;
    case EvalOp::Asin:
      return ProgramOp::Asin;
    case EvalOp::Acos:
      return ProgramOp::Acos;
    case EvalOp::Atan:
      return ProgramOp::Atan;
    case EvalOp::Tanh:
      return ProgramOp::Tanh;
    case EvalOp::Min:
      return ProgramOp::Min;
    case EvalOp::Max:
      return ProgramOp::Max;
    case EvalOp::Atan2:
      return ProgramOp::Atan2;
    case EvalOp::Hypot:
      return ProgramOp::Hypot;
    case EvalOp::Mod:
      return ProgramOp::Mod;
  }
  assert(false && "every operation is listed");
  return ProgramOp::Copy;
}

// Small whole powers and the square root are far cheaper than the general power.
bool append_special_power(ProgramBuilder& builder, ProgramPlace target, ProgramPlace base, double exponent) {
  if (exponent == 0.5) {
    builder.emit(ProgramOp::Sqrt, target, base);
  } else if (exponent == 1) {
    builder.emit(ProgramOp::Copy, target, base);
  } else if (exponent == 2) {
    builder.emit(ProgramOp::Multiply, target, base, base);
  } else if (exponent == 3 || exponent == 4) {
    const std::uint32_t mark = builder.temporaries_in_use();
    const ProgramPlace square = builder.new_temporary();
    builder.emit(ProgramOp::Multiply, square, base, base);
    builder.emit(ProgramOp::Multiply, target, square, exponent == 3 ? base : square);
    builder.release(mark);
  } else {
    return false;
  }
  return true;
}

}  // namespace

ProgramPlace ProgramBuilder::constant(double value) {
  // By bits, so that 0 and -0 stay apart.
  const auto is_same = [&](double c) { return std::bit_cast<std::uint64_t>(c) == std::bit_cast<std::uint64_t>(value); };
  const auto found = std::find_if(constants_.begin(), constants_.end(), is_same);
  const auto index = static_cast<std::uint32_t>(found - constants_.begin());
  if (found == constants_.end()) {
    constants_.push_back(value);
  }
  return {ProgramPlace::Kind::Constant, index};
}

ProgramPlace ProgramBuilder::column(std::vector<double> values) {
  const auto found = std::find(columns_.begin(), columns_.end(), values);
  const auto index = static_cast<std::uint32_t>(found - columns_.begin());
  if (found == columns_.end()) {
    columns_.push_back(std::move(values));
  }
  return {ProgramPlace::Kind::Column, index};
}

ProgramPlace ProgramBuilder::values(const std::vector<double>& values) {
  return values.size() == 1 ? constant(values[0]) : column(values);
}

void ProgramBuilder::begin(ProgramPart part) {
  part_ = static_cast<std::size_t>(part);
  in_use_ = 0;
}

ProgramPlace ProgramBuilder::new_temporary() {
  temporary_count_ = std::max(temporary_count_, in_use_ + 1);
  return {ProgramPlace::Kind::Temporary, in_use_++};
}

void ProgramBuilder::emit(ProgramOp op, ProgramPlace target, ProgramPlace a, ProgramPlace b, ProgramPlace c) {
  parts_[part_].push_back({op, target, a, b, c});
}

void ProgramBuilder::assign(ProgramPlace target, ProgramPlace value) {
  std::vector<Step>& steps = parts_[part_];
  const bool is_fresh = value.kind == ProgramPlace::Kind::Temporary && !steps.empty() && steps.back().target == value;
  if (is_fresh) {
    steps.back().target = target;
  } else if (!(value == target)) {
    emit(ProgramOp::Copy, target, value);
  }
}

std::uint32_t ProgramBuilder::operand(ProgramPlace place) const {
  const std::uint32_t first[] = {
      0, state_count_, state_count_ + input_count_,
      state_count_ + input_count_ + static_cast<std::uint32_t>(columns_.size()),
      state_count_ + input_count_ + static_cast<std::uint32_t>(columns_.size() + constants_.size())};
  return first[static_cast<std::size_t>(place.kind)] + place.index;
}

std::vector<std::uint32_t> ProgramBuilder::words(ProgramPlace fires, const std::vector<ProgramPlace>& initial,
                                                 std::uint32_t refractory_ticks, std::uint32_t hold_mask) const {
  ProgramHeader header{};
  header.version = kProgramVersion;
  header.state_count = state_count_;
  header.input_count = input_count_;
  header.column_count = static_cast<std::uint32_t>(columns_.size());
  header.constant_count = static_cast<std::uint32_t>(constants_.size());
  header.temporary_count = temporary_count_;
  header.update_count = static_cast<std::uint32_t>(parts_[0].size());
  header.threshold_count = static_cast<std::uint32_t>(parts_[1].size());
  header.reset_count = static_cast<std::uint32_t>(parts_[2].size());
  header.fires = operand(fires);
  header.refractory_ticks = refractory_ticks;
  header.hold_mask = hold_mask;
  const auto head = std::bit_cast<std::array<std::uint32_t, kProgramHeaderWords>>(header);
  std::vector<std::uint32_t> all(head.begin(), head.end());
  for (const ProgramPlace place : initial) {
    all.push_back(operand(place));
  }
  for (const std::vector<Step>& steps : parts_) {
    for (const Step& step : steps) {
      const std::uint32_t reads = operand_count(step.op);
      all.insert(all.end(), {static_cast<std::uint32_t>(step.op), operand(step.target), operand(step.a),
                             reads > 1 ? operand(step.b) : 0, reads > 2 ? operand(step.c) : 0});
    }
  }
  return all;
}

ProgramPlace append_expression(const TypedExpression& expression, const std::vector<ProgramPlace>& slots,
                               ProgramBuilder& builder) {
  // Taken at the first write: some of the expression's own are never used.
  std::vector<std::optional<ProgramPlace>> temporaries(expression.temporary_count);
  const auto place = [&](EvalOperand operand) {
    switch (operand.kind) {
      case EvalOperand::Kind::Constant:
        return builder.constant(expression.constants[operand.index]);
      case EvalOperand::Kind::Slot:
        return slots[operand.index];
      case EvalOperand::Kind::Temporary:
        break;
    }
    return temporaries[operand.index].value();
  };
  for (const EvalInstruction& step : expression.program) {
    std::optional<ProgramPlace>& temporary = temporaries[step.target];
    if (!temporary) {
      temporary = builder.new_temporary();
    }
    const ProgramPlace target = *temporary;
    const bool is_power = step.op == EvalOp::Power && step.b.kind == EvalOperand::Kind::Constant;
    if (is_power && append_special_power(builder, target, place(step.a), expression.constants[step.b.index])) {
      continue;
    }
    const ProgramOp op = program_op(step.op);
    const std::uint32_t reads = operand_count(op);
    builder.emit(op, target, place(step.a), reads > 1 ? place(step.b) : ProgramPlace{},
                 reads > 2 ? place(step.c) : ProgramPlace{});
  }
  return place(expression.result);
}

}  // namespace tectum
