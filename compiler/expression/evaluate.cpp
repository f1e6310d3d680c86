#include "compiler/expression/evaluate.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace tectum {
namespace {

// 256 doubles are 2 kB: a dozen registers stay in the first-level cache.
constexpr std::size_t kBlock = 256;

template <typename Function>
void map_block(double* out, const double* a, std::size_t n, Function f) {
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = f(a[i]);
  }
}

template <typename Function>
void map_block(double* out, const double* a, const double* b, std::size_t n, Function f) {
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = f(a[i], b[i]);
  }
}

double as_truth(bool value) { return value ? 1.0 : 0.0; }
double sign_of(double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; }
// Floored division, so that the result has the divisor's sign: mod(-1, 4) is 3.
double floored_mod(double a, double b) { return a - b * std::floor(a / b); }

// The steps that are worth a loop of their own; false when `op` is none of them.
bool run_arithmetic(EvalOp op, double* out, const double* a, const double* b, std::size_t n) {
  switch (op) {
    case EvalOp::Add:
      map_block(out, a, b, n, [](double x, double y) { return x + y; });
      return true;
    case EvalOp::Subtract:
      map_block(out, a, b, n, [](double x, double y) { return x - y; });
      return true;
    case EvalOp::Multiply:
      map_block(out, a, b, n, [](double x, double y) { return x * y; });
      return true;
    case EvalOp::Divide:
      map_block(out, a, b, n, [](double x, double y) { return x / y; });
      return true;
    case EvalOp::Equal:
      map_block(out, a, b, n, [](double x, double y) { return as_truth(x == y); });
      return true;
    case EvalOp::NotEqual:
      map_block(out, a, b, n, [](double x, double y) { return as_truth(x != y); });
      return true;
    case EvalOp::Less:
      map_block(out, a, b, n, [](double x, double y) { return as_truth(x < y); });
      return true;
    case EvalOp::LessEqual:
      map_block(out, a, b, n, [](double x, double y) { return as_truth(x <= y); });
      return true;
    case EvalOp::Min:
      map_block(out, a, b, n, [](double x, double y) { return y < x ? y : x; });
      return true;
    case EvalOp::Max:
      map_block(out, a, b, n, [](double x, double y) { return x < y ? y : x; });
      return true;
    case EvalOp::Negate:
      map_block(out, a, n, [](double x) { return -x; });
      return true;
    case EvalOp::Abs:
      map_block(out, a, n, [](double x) { return std::abs(x); });
      return true;
    case EvalOp::Sqrt:
      map_block(out, a, n, [](double x) { return std::sqrt(x); });
      return true;
    case EvalOp::Exp:
      map_block(out, a, n, [](double x) { return std::exp(x); });
      return true;
    case EvalOp::Log:
      map_block(out, a, n, [](double x) { return std::log(x); });
      return true;
    default:
      return false;
  }
}

}  // namespace

double apply_step(EvalOp op, double a, double b, double c) {
  switch (op) {
    case EvalOp::Negate:
      return -a;
    case EvalOp::Not:
      return as_truth(a == 0);
    case EvalOp::Add:
      return a + b;
    case EvalOp::Subtract:
      return a - b;
    case EvalOp::Multiply:
      return a * b;
    case EvalOp::Divide:
      return a / b;
    case EvalOp::Power:
      return std::pow(a, b);
    case EvalOp::Equal:
      return as_truth(a == b);
    case EvalOp::NotEqual:
      return as_truth(a != b);
    case EvalOp::Less:
      return as_truth(a < b);
    case EvalOp::LessEqual:
      return as_truth(a <= b);
    case EvalOp::And:
      return as_truth(a != 0 && b != 0);
    case EvalOp::Or:
      return as_truth(a != 0 || b != 0);
    case EvalOp::Select:
      return a != 0 ? b : c;
    case EvalOp::Exp:
      return std::exp(a);
    case EvalOp::Log:
      return std::log(a);
    case EvalOp::Log2:
      return std::log2(a);
    case EvalOp::Log10:
      return std::log10(a);
    case EvalOp::Sqrt:
      return std::sqrt(a);
    case EvalOp::Abs:
      return std::abs(a);
    case EvalOp::Floor:
      return std::floor(a);
    case EvalOp::Ceil:
      return std::ceil(a);
    case EvalOp::Sign:
      return sign_of(a);
    case EvalOp::Sin:
      return std::sin(a);
    case EvalOp::Cos:
      return std::cos(a);
    case EvalOp::Tan:
      return std::tan(a);
    case EvalOp::Asin:
      return std::asin(a);
    case EvalOp::Acos:
      return std::acos(a);
    case EvalOp::Atan:
      return std::atan(a);
    case EvalOp::Tanh:
      return std::tanh(a);
    case EvalOp::Min:
      return b < a ? b : a;
    case EvalOp::Max:
      return a < b ? b : a;
    case EvalOp::Atan2:
      return std::atan2(a, b);
    case EvalOp::Hypot:
      return std::hypot(a, b);
    case EvalOp::Mod:
      return floored_mod(a, b);
  }
  assert(false && "every step is listed");
  return 0;
}

Evaluator::Evaluator(const TypedExpression& expression) : expression_(&expression) {
  const std::size_t blocks = expression.temporary_count + expression.constants.size() + expression.slot_count;
  scratch_.resize(blocks * kBlock);
  double* constant_block = scratch_.data() + expression.temporary_count * kBlock;
  for (const double constant : expression.constants) {
    std::fill_n(constant_block, kBlock, constant);
    constant_block += kBlock;
  }
}

void Evaluator::evaluate(std::span<const EvalColumn> columns, std::span<double> out) {
  const TypedExpression& e = *expression_;
  assert(columns.size() >= e.slot_count);
  double* const temporaries = scratch_.data();
  double* const constants = temporaries + e.temporary_count * kBlock;
  double* const slots = constants + e.constants.size() * kBlock;
  for (std::size_t begin = 0; begin < out.size(); begin += kBlock) {
    const std::size_t n = std::min(kBlock, out.size() - begin);
    for (std::size_t s = 0; s < e.slot_count; ++s) {
      const EvalColumn& column = columns[s];
      if (column.data == nullptr || column.stride == 1) {
        continue;
      }
      for (std::size_t i = 0; i < n; ++i) {
        slots[s * kBlock + i] = column.data[(begin + i) * column.stride];
      }
    }
    const auto read = [&](EvalOperand operand) -> const double* {
      switch (operand.kind) {
        case EvalOperand::Kind::Temporary:
          return temporaries + operand.index * kBlock;
        case EvalOperand::Kind::Constant:
          return constants + operand.index * kBlock;
        case EvalOperand::Kind::Slot:
          break;
      }
      const EvalColumn& column = columns[operand.index];
      return column.stride == 1 ? column.data + begin : slots + operand.index * kBlock;
    };
    for (const EvalInstruction& step : e.program) {
      double* target = temporaries + step.target * kBlock;
      const double* a = read(step.a);
      const double* b = read(step.b);
      if (run_arithmetic(step.op, target, a, b, n)) {
        continue;
      }
      const double* c = read(step.c);
      for (std::size_t i = 0; i < n; ++i) {
        target[i] = apply_step(step.op, a[i], b[i], c[i]);
      }
    }
    std::copy_n(read(e.result), n, out.data() + begin);
  }
}

double Evaluator::evaluate_one(std::span<const double> slots) {
  std::vector<EvalColumn> columns;
  for (const double& value : slots) {
    columns.push_back({&value, 0});
  }
  double result = 0;
  evaluate(columns, {&result, 1});
  return result;
}

}  // namespace tectum
