// Evaluation over blocks of pre- and postsynaptic variables.
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "compiler/expression/expression.h"

using namespace tectum;

namespace {

Environment geometry() {
  Environment e;
  e.add_constant("g_sc", {0.9, kCurrent});
  e.add_variable("ecc", kAngle, 0);
  e.add_variable("x", kAngle, 1);
  e.add_variable("hemifield", kWord, 2);
  e.add_variable("side", kWord, 3);
  e.add_word("left", 0);
  e.add_word("right", 1);
  return e;
}

TypedExpression typed(std::string_view text) {
  std::vector<ExprError> errors;
  const auto expression = parse_expression(text, errors);
  REQUIRE(expression);
  auto result = type_expression(*expression, geometry(), errors);
  REQUIRE(result);
  return *result;
}

}  // namespace

TEST_CASE("one value at a time") {
  const double at[] = {12, -3, 0, 1};
  const auto value = [&](std::string_view text) {
    const TypedExpression e = typed(text);
    return Evaluator(e).evaluate_one(at);
  };
  CHECK(value("ecc") == 12);
  CHECK(value("7 mV") == 7);
  CHECK(value("g_sc * ln(1 + ecc / 12 deg)") == doctest::Approx(0.9 * std::log(2.0)));
  CHECK(value("hemifield == side") == 0);
  CHECK(value("hemifield == left and x < 0 deg") == 1);
  CHECK(value("hemifield != side ? ecc : x") == 12);
  CHECK(value("max(x, ecc, 5 deg)") == 12);
  CHECK(value("min(x, 1 deg, ecc)") == -3);
  CHECK(value("clamp(ecc, 0 deg, 5 deg)") == 5);
  CHECK(value("sin(ecc * 2.5)") == doctest::Approx(0.5));
  CHECK(value("atan2(x, -x) / 1 deg") == doctest::Approx(-45));
  CHECK(value("exp(-(x / 3 deg)^2)") == doctest::Approx(std::exp(-1.0)));
  CHECK(value("true ? x * 2 : ecc") == -6);
  CHECK(value("1 deg + (false ? x * 2 : ecc * 3)") == 37);
  CHECK(value("(x + (ecc + (x + (ecc + 1 deg)))) * 2") == 38);
  CHECK(value("not (ecc >= 12 deg)") == 0);
  CHECK(value("-abs(x)") == -3);
}

TEST_CASE("columns may be whole arrays, strided arrays, or one value for all") {
  const TypedExpression e = typed("ecc * 2 + x");
  std::vector<double> ecc(1000);
  std::vector<double> interleaved(2000);
  for (std::size_t i = 0; i < ecc.size(); ++i) {
    ecc[i] = static_cast<double>(i);
    interleaved[2 * i + 1] = static_cast<double>(i % 7);
  }
  std::vector<double> out(1000);
  Evaluator evaluator(e);
  const EvalColumn columns[] = {{ecc.data(), 1}, {interleaved.data() + 1, 2}};
  evaluator.evaluate(columns, out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    REQUIRE(out[i] == ecc[i] * 2 + static_cast<double>(i % 7));
  }

  const double one_x = 100;
  const EvalColumn broadcast[] = {{ecc.data(), 1}, {&one_x, 0}};
  evaluator.evaluate(broadcast, out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    REQUIRE(out[i] == ecc[i] * 2 + 100);
  }
}

TEST_CASE("a million synapses take tens of milliseconds") {
  const TypedExpression e = typed("g_sc * ln(1 + ecc / 12 deg) * (hemifield == side ? 1 : 0.5)");
  std::vector<double> ecc(1'000'000, 7.0);
  std::vector<double> out(ecc.size());
  const double side = 1;
  const EvalColumn columns[] = {{ecc.data(), 1}, {}, {&side, 0}, {&side, 0}};
  Evaluator evaluator(e);
  const auto start = std::chrono::steady_clock::now();
  evaluator.evaluate(columns, out);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  MESSAGE("1e6 evaluations in " << ms << " ms");
  CHECK(out.back() == doctest::Approx(0.9 * std::log(1 + 7.0 / 12)));
  CHECK(ms < 1000);  // generous: sanitizers and loaded machines; the figure itself is printed above
}
