// Parsing, typing and folding of expressions, each asserted through plain values and messages.
#include "compiler/expression/expression.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace tectum;

namespace {

Environment circuit_names() {
  Environment e;
  e.add_constant("g_sc", {0.9, kCurrent});
  e.add_constant("tau_burst", {5, kTime});
  e.add_constant("n", {0, kNumber});
  e.add_variable("ecc", kAngle, 0);
  e.add_variable("pre.index", kNumber, 1);
  e.add_variable("hemifield", kWord, 2);
  e.add_variable("x", kAngle, 3);
  e.add_word("side", 1);
  e.add_word("left", 0);
  e.add_word("right", 1);
  return e;
}

// "0.9 nA", or the error's message.
std::string value_of(std::string_view text) {
  std::vector<ExprError> errors;
  const std::optional<Quantity> value = evaluate_constant(text, circuit_names(), errors);
  CHECK(value.has_value() == errors.empty());
  return value ? format_quantity(*value) : errors[0].message;
}

struct Failure {
  std::string marked;  // the text under the carets
  std::string message;
  std::string help;
};

std::vector<Failure> failures(const std::string& text) {
  std::vector<ExprError> errors;
  if (const auto expression = parse_expression(text, errors)) {
    static_cast<void>(type_expression(*expression, circuit_names(), errors));
  }
  std::vector<Failure> found;
  for (const ExprError& e : errors) {
    REQUIRE(e.span.begin <= e.span.end);
    REQUIRE(e.span.end <= text.size());
    found.push_back({text.substr(e.span.begin, e.span.end - e.span.begin), e.message, e.help});
  }
  return found;
}

}  // namespace

TEST_CASE("plain values") {
  struct Row {
    std::string_view text;
    std::string_view expected;
  };
  const Row rows[] = {
      {"20 ms", "20 ms"},
      {"0.1ms", "0.1 ms"},
      {"900 pA", "0.9 nA"},
      {"1.5 s", "1500 ms"},
      {"-70 mV", "-70 mV"},
      {"250 Hz", "250 Hz"},
      {"0.02 deg/Hz", "0.02 deg/Hz"},
      {"1/ms", "1000 Hz"},
      {"5 %", "0.05"},
      {"60 deg/s", "60 deg/s"},
      {"2 deg/s/Hz", "2 deg"},
      {"1 rad", "57.29577951308232 deg"},
      {"30 arcmin", "0.5 deg"},
      {"40 MOhm * 0.5 nA", "20 mV"},
      {"40 MΩ * 500 pA", "20 mV"},
      {"10 MOhm * 2 nF", "20 ms"},
      {"1 + 2 * 3 ^ 2", "19"},
      {"2 ^ 3 ^ 2", "512"},
      {"-2 ^ 2", "-4"},
      {"2 ^ -1", "0.5"},
      {"2 * -3", "-6"},
      {"- - 3", "3"},
      {"10 - 4 - 3", "3"},
      {"(1 + 2) * 3", "9"},
      {"1 < 2 and 3 < 2", "false"},
      {"not 1 == 2", "true"},
      {"!(1 == 2) || false", "true"},
      {"1 < 2 ? 5 mV : 6 mV", "5 mV"},
      {"if(left == right, 1, 2)", "2"},
      {"false ? 1 : true ? 2 : 3", "2"},
      {"g_sc * ln(1 + 12 deg / 12 deg)", "0.6238324625039507 nA"},
      {"sqrt(9 mV * 4 mV)", "6 mV"},
      {"(4 mV^2) ^ 0.5", "2 mV"},
      {"min(3, 1, 2)", "1"},
      {"max(3 mV, 1 mV)", "3 mV"},
      {"clamp(7, 0, 5)", "5"},
      {"clamp(-7, 0, 5)", "0"},
      {"sin(30 deg)", "0.49999999999999994"},
      {"cos(pi)", "-1"},
      {"atan2(1 m, 1 m)", "45 deg"},
      {"mod(-1, 4)", "3"},
      {"sign(-3 mV)", "-1"},
      {"floor(2.7) + ceil(2.2)", "5"},
      {"tau_burst / 10", "0.5 ms"},
      {"1 / 5 mV/ms", "0.2 ms/mV"},
      {"1 / 5 mV / ms", "0.2 1/ms/mV"},
      {"n == 0 ? 7 : 1 / n", "7"},
      {"3 px", "3 px"},
      {".5", "0.5"},
      {"1e-3 s", "1 ms"},
      {"0.1 m", "0.1 m"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    CHECK(value_of(row.text) == row.expected);
  }
}

TEST_CASE("decimal units are exact to the last bit") {
  std::vector<ExprError> errors;
  const Environment none;
  CHECK(evaluate_constant("900 pA", none, errors)->value == 0.9);
  CHECK(evaluate_constant("0.3 ms", none, errors)->value == 0.3);
  CHECK(evaluate_constant("300 us", none, errors)->value == 0.3);
  CHECK(evaluate_constant("7 %", none, errors)->value == 0.07);
  CHECK(evaluate_constant("70 Hz", none, errors)->value == 0.07);
  CHECK(in_hz(evaluate_constant("250 Hz", none, errors)->value) == 250);
}

TEST_CASE("errors mark the narrowest part and say what was seen") {
  struct Row {
    std::string text;
    std::string marked;
    std::string message;
    std::string help;
  };
  const Row rows[] = {
      {"3 mV + 2 nA", "2 nA", "adds current (nA) to voltage (mV)", ""},
      {"3 mV - tau_burst", "tau_burst", "subtracts time (ms) from voltage (mV)", ""},
      {"ecc > 3", "3", "compares angle (deg) and number", "write `3 deg`"},
      {"ln(ecc)", "ecc", "`ln` of angle (deg), expected a number", "divide by a value in the same unit"},
      {"ecc / 12 dge", "dge", "unknown unit `dge`", "did you mean `deg`?"},
      {"20 msec", "msec", "unknown unit `msec`", "did you mean `ms`?"},
      {"20 mv", "mv", "unknown unit `mv`", "did you mean `mV`?"},
      {"2 ecc", "ecc", "unknown unit `ecc`", "to multiply, write `*` between the number and the name"},
      {"1 + eccc / 2 deg", "eccc", "unknown name `eccc`", "did you mean `ecc`?"},
      {"exq(1)", "exq", "unknown function `exq`", "did you mean `exp`?"},
      {"log(2)", "log", "unknown function `log`", "natural logarithm is `ln`, to other bases `log2` and `log10`"},
      {"sqrt", "sqrt", "unknown name `sqrt`", "`sqrt` is a function: its arguments go in brackets"},
      {"atan2(1)", "atan2(1)", "`atan2` takes 2 arguments, found 1", "atan2(y, x): the direction of the point (x, y)"},
      {"max()", "max()", "`max` takes 2 or more arguments, found 0", "the largest of two or more"},
      {"min(1 mV, 2 nA)", "2 nA", "`min` mixes voltage (mV) and current (nA)", ""},
      {"if(1, 2, 3)", "1", "expected a truth value, found number", "compare it with something"},
      {"if(true, 2 mV, 3 nA)", "3 nA", "chooses between voltage (mV) and current (nA)", ""},
      {"hemifield + 1", "hemifield", "expected a quantity, found a word", ""},
      {"hemifield < side", "hemifield", "expected a quantity, found a word", ""},
      {"hemifield == 1", "1", "compares word and number", ""},
      {"ecc ^ 0.5", "0.5", "angle (deg) to this power has no whole powers of its units", ""},
      {"ecc ^ n ^ pre.index", "n ^ pre.index", "base is angle (deg), so the exponent must be a constant", ""},
      {"2 ^ 3 mV", "3 mV", "exponent is voltage (mV), expected a number", ""},
      {"sqrt(ecc)", "ecc", "square root of angle (deg) has no whole powers of its units", ""},
      {"sin(3 mV)", "3 mV", "`sin` of voltage (mV), expected an angle", ""},
      {"ecc * (1 / n)", "(1 / n)", "`(1 / n)` has no finite value", ""},
      {"ln(-1)", "ln(-1)", "`ln(-1)` has no finite value", ""},
      {"x = 3", "=", "expected an operator, found `=`", "comparison is written `==`"},
      {"1 +", "+", "expected a value, the expression ends here", ""},
      {"", "", "expression is empty", ""},
      {"  ", " ", "expression is empty", ""},
      {"(1 + 2", "(", "`(` is never closed", ""},
      {"(1 + 2]", "]", "expected an operator or `)`, found `]`", ""},
      {"max(1, )", ")", "expected an argument, found `)`", ""},
      {"1.2.3", "1.2.3", "malformed number", ""},
      {"1e999", "1e999", "number is out of range", ""},
      {"ecc x", "x", "expected an operator, found `x`", "to multiply, write `*`"},
      {"1 2", "2", "expected an operator, found `2`", "to multiply, write `*`"},
      {"3 $ 4", "$", "expected an operator, found `$`", ""},
      {"1 + \x1b[31m", "\x1b", "expected a value, found `\\x1b`", ""},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    const std::vector<Failure> found = failures(row.text);
    REQUIRE(found.size() == 1);
    if (!row.text.empty()) {
      CHECK(found[0].marked == row.marked);
    }
    CHECK(found[0].message == row.message);
    CHECK(found[0].help == row.help);
  }
}

TEST_CASE("every typing error is reported, in source order, and none that only follows from another") {
  const std::vector<Failure> found = failures("ln(nope) + eccc * sqrt(1, 2) + foo(ecc) + (1 mV + 2 nA)");
  REQUIRE(found.size() == 5);
  CHECK(found[0].marked == "nope");
  CHECK(found[1].marked == "eccc");
  CHECK(found[2].marked == "sqrt(1, 2)");
  CHECK(found[3].marked == "foo");
  CHECK(found[4].marked == "2 nA");
}

TEST_CASE("a clash names both places") {
  std::vector<ExprError> errors;
  const auto expression = parse_expression("tau_burst + ecc", errors);
  REQUIRE(expression);
  CHECK_FALSE(type_expression(*expression, circuit_names(), errors));
  REQUIRE(errors.size() == 1);
  REQUIRE(errors[0].other);
  CHECK(expression->text_of(*errors[0].other) == "tau_burst");
  CHECK(errors[0].other_label == "this is time (ms)");
}

TEST_CASE("a name of the circuit hides a unit, and a unit that swallowed one is reported") {
  Environment e;
  e.add_variable("m", kNumber, 0);
  std::vector<ExprError> errors;
  CHECK(type_expression(*parse_expression("100 mV / m", errors), e, errors)->dimension == kVoltage);
  CHECK_FALSE(type_expression(*parse_expression("100 mV/m", errors), e, errors));
  REQUIRE(errors.size() == 1);
  CHECK(errors[0].code == ExprErrorCode::AmbiguousUnit);
  CHECK(errors[0].message == "`m` is both a unit and a name here");
}

TEST_CASE("a variable where a constant is wanted is named") {
  CHECK(value_of("g_sc * pre.index") == "`pre.index` varies, and a constant is expected here");
}

TEST_CASE("a value of the wrong dimension says both") {
  std::vector<ExprError> errors;
  const auto expression = parse_expression("3", errors);
  const ExprError error = dimension_error(*expression, kCurrent, kNumber);
  CHECK(error.message == "expected current (nA), found number");
  CHECK(error.help == "write `3 nA`");
}

TEST_CASE("hostile text ends in an error value") {
  const auto first_code = [](const std::string& text) {
    std::vector<ExprError> errors;
    CHECK_FALSE(parse_expression(text, errors));
    REQUIRE(errors.size() == 1);
    return errors[0].code;
  };
  CHECK(first_code(std::string(10000, '(')) == ExprErrorCode::TooComplex);
  CHECK(first_code(std::string(10000, '-')) == ExprErrorCode::TooComplex);
  CHECK(first_code(std::string(100000, '1')) == ExprErrorCode::TooComplex);
  CHECK(first_code("max(1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1)") == ExprErrorCode::TooComplex);
  std::string powers = "2";
  for (int i = 0; i < 2000; ++i) {
    powers += "^2";
  }
  CHECK(first_code(powers) == ExprErrorCode::TooComplex);
}

TEST_CASE("a chain of thousands of terms is no depth") {
  std::string sum = "1";
  for (int i = 0; i < 5000; ++i) {
    sum += "+1";
  }
  CHECK(value_of(sum) == "5001");
}

TEST_CASE("names in use come with their places") {
  std::vector<ExprError> errors;
  const auto expression = parse_expression("g_sc * ln(1 + ecc / tau.x)", errors);
  REQUIRE(expression);
  const std::vector<NameUse> names = names_in(*expression);
  REQUIRE(names.size() == 3);
  CHECK(names[0].name == "g_sc");
  CHECK(names[1].name == "ecc");
  CHECK(names[2].name == "tau.x");
  CHECK(names[2].span == ExprSpan{20, 25});
}
