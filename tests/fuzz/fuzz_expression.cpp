// Any text as an expression: parsed, typed, folded, evaluated, split into a linear form.
#include <cmath>
#include <cstdint>
#include <string_view>

#include "compiler/expression/expression.h"
#include "compiler/expression/linear_split.h"
#include "tests/fuzz/expect.h"

using namespace tectum;

namespace {

Environment names() {
  Environment e;
  e.add_constant("g", {0.9, kCurrent});
  e.add_constant("zero", {0, kNumber});
  e.add_variable("ecc", kAngle, 0);
  e.add_variable("n", kNumber, 1);
  e.add_variable("side", kWord, 2);
  e.add_variable("m", kNumber, 3);
  e.add_word("left", 0);
  return e;
}

void check_errors(std::string_view text, const std::vector<ExprError>& errors) {
  for (const ExprError& error : errors) {
    TECTUM_EXPECT(error.span.begin <= error.span.end && error.span.end <= text.size());
    TECTUM_EXPECT(!error.message.empty());
    if (error.other) {
      TECTUM_EXPECT(error.other->begin <= error.other->end && error.other->end <= text.size());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Environment environment = names();
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::vector<ExprError> errors;
  const auto expression = parse_expression(text, errors);
  check_errors(text, errors);
  TECTUM_EXPECT(expression ? errors.empty() : errors.size() == 1);
  if (!expression) {
    return 0;
  }
  for (const NameUse& use : names_in(*expression)) {
    TECTUM_EXPECT(text.substr(use.span.begin, use.name.size()) == use.name);
  }
  const auto typed = type_expression(*expression, environment, errors);
  check_errors(text, errors);
  TECTUM_EXPECT(typed.has_value() == errors.empty());
  if (!typed) {
    return 0;
  }
  TECTUM_EXPECT(!typed->constant || std::isfinite(*typed->constant));
  const double slots[] = {12, 3, 1, 0.5};
  const double value = Evaluator(*typed).evaluate_one(slots);
  TECTUM_EXPECT(!typed->constant || value == *typed->constant);

  // Where the form is linear, offset + slope * variable is the value, up to rounding.
  const LinearSplit split = split_linear(
      *expression, 1, [](std::string_view name) { return name == "n" ? std::optional<std::size_t>(0) : std::nullopt; });
  if (split.nonlinear) {
    return 0;
  }
  double sum = 0;
  for (const auto* part : {&split.offset, &split.slopes[0]}) {
    if (!*part) {
      continue;
    }
    std::vector<ExprError> part_errors;
    const auto part_typed = type_expression(**part, environment, part_errors);
    if (!part_typed) {
      return 0;
    }  // a constant that is not finite, hidden before by a choice
    sum += Evaluator(*part_typed).evaluate_one(slots) * (part == &split.offset ? 1 : slots[1]);
  }
  const double scale = std::abs(value) + std::abs(sum);
  if (std::isfinite(scale) && scale < 1e6) {
    TECTUM_EXPECT(std::abs(value - sum) <= 1e-3 * scale + 1e-3);
  }
  return 0;
}
