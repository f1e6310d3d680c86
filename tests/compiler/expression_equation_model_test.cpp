// Equation models: what is refused and where, and the programs they become.
#include "compiler/expression/equation_model.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "compiler/expression/linear_split.h"
#include "compiler/expression/matrix_exponential.h"
#include "runtime/image/program.h"

using namespace tectum;

namespace {

EquationModelText lif() {
  EquationModelText text;
  text.parameters = {
      {"tau_m", "20 ms"}, {"E_L", "-70 mV"}, {"V_th", "-50 mV"}, {"R_m", "10 MOhm"}, {"V_reset", "E_L + 5 mV"}};
  text.inputs = {{"ex", kCurrent}};
  text.states = {{"v", "E_L"}, {"I", "0 nA"}};
  text.equations = {{"dv/dt", "(E_L - v + R_m * I) / tau_m"}, {"dI/dt", "-I / 5 ms"}, {"I", "I + ex"}};
  text.threshold = "v >= V_th";
  text.reset = {{"v", "V_reset"}};
  text.refractory = "2 ms";
  return text;
}

Environment circuit() {
  Environment e;
  e.add_constant("g", {0.5, kCurrent});
  return e;
}

struct Found {
  EquationErrorCode code;
  std::string marked;
  std::string message;
};

// Text that an error points into.
std::string part_text(const EquationModelText& text, const EquationError& error) {
  const auto pick = [&](const std::vector<EquationText>& list) {
    return error.is_in_name ? list.at(error.index).name : list.at(error.index).text;
  };
  switch (error.part) {
    case EquationPart::Parameter:
      return pick(text.parameters);
    case EquationPart::Input:
      return text.inputs.at(error.index).name;
    case EquationPart::State:
      return pick(text.states);
    case EquationPart::Equation:
      return pick(text.equations);
    case EquationPart::Threshold:
      return text.threshold;
    case EquationPart::Reset:
      return pick(text.reset);
    case EquationPart::Refractory:
      return text.refractory;
    case EquationPart::Hold:
      return text.hold->at(error.index);
  }
  return {};
}

std::vector<Found> errors_of(const EquationModelText& text, double tick_ms = 0.1) {
  std::vector<EquationError> errors;
  const auto model = check_equation_model(text, circuit(), errors);
  CHECK(model.has_value() == errors.empty());
  if (model) {
    const auto program = compile_equations(*model, {}, 1, tick_ms, errors);
    CHECK(program.has_value() == errors.empty());
    std::string why;
    if (program) {
      CHECK_MESSAGE(verify_program(program->words, why), why);
    }
  }
  std::vector<Found> found;
  for (const EquationError& e : errors) {
    const std::string part = part_text(text, e);
    REQUIRE(e.error.span.end <= part.size());
    found.push_back({e.code, part.substr(e.error.span.begin, e.error.span.end - e.error.span.begin), e.error.message});
  }
  return found;
}

}  // namespace

TEST_CASE("a well-formed model has no errors") { CHECK(errors_of(lif()).empty()); }

TEST_CASE("each mistake is found where it is") {
  struct Row {
    void (*spoil)(EquationModelText&);
    EquationErrorCode code;
    std::string marked;
    std::string message;
  };
  using Code = EquationErrorCode;
  const Row rows[] = {
      {[](EquationModelText& m) { m.equations[0].text = "(E_L - v + R_m) / tau_m"; }, Code::Expression, "R_m",
       "adds resistance (MOhm) to voltage (mV)"},
      {[](EquationModelText& m) { m.equations[0].text = "E_L - v"; }, Code::Expression, "E_L - v",
       "expected voltage per time (mV/ms), found voltage (mV)"},
      {[](EquationModelText& m) { m.equations[2].text = "I + v"; }, Code::Expression, "v",
       "adds voltage (mV) to current (nA)"},
      {[](EquationModelText& m) { m.equations[0].name = "dV/dt"; }, Code::UnknownState, "V", "unknown state `V`"},
      {[](EquationModelText& m) {
         m.equations[1] = {"dv/dt", "1 mV/ms"};
       },
       Code::DuplicateName, "dv/dt", "a second equation for `dv/dt`"},
      {[](EquationModelText& m) {
         m.equations[1].name = "dv/dt";
         m.equations.erase(m.equations.begin());
       },
       Code::Expression, "-I / 5 ms", "expected voltage per time (mV/ms), found nA/ms"},
      {[](EquationModelText& m) { m.threshold = "v - V_th"; }, Code::Expression, "v - V_th",
       "expected truth value, found voltage (mV)"},
      {[](EquationModelText& m) { m.threshold = ""; }, Code::Expression, "", "expression is empty"},
      {[](EquationModelText& m) { m.reset[0].text = "0"; }, Code::Expression, "0",
       "expected voltage (mV), found number"},
      {[](EquationModelText& m) { m.reset[0].name = "w"; }, Code::UnknownState, "w", "unknown state `w`"},
      {[](EquationModelText& m) { m.refractory = "2 mV"; }, Code::Expression, "2 mV",
       "expected time (ms), found voltage (mV)"},
      {[](EquationModelText& m) { m.refractory = "0.25 ms"; }, Code::NotWholeTicks, "0.25 ms",
       "refractory time is 0.25 ms, expected a whole number of ticks of 0.1 ms up to 65535"},
      {[](EquationModelText& m) { m.refractory = "I / I * 1 ms"; }, Code::NotConstant, "I",
       "`I` is a state, and a constant is expected here"},
      {[](EquationModelText& m) { m.states[0].text = "ex * 1 MOhm"; }, Code::NotConstant, "ex",
       "`ex` is a receptor, and a constant is expected here"},
      {[](EquationModelText& m) { m.hold = std::vector<std::string>{"u"}; }, Code::UnknownState, "u",
       "unknown state `u`"},
      {[](EquationModelText& m) {
         m.parameters.push_back({"v", "1"});
       },
       Code::DuplicateName, "v", "`v` is already a parameter"},
      {[](EquationModelText& m) {
         m.states.push_back({"dt", "1"});
       },
       Code::DuplicateName, "dt", "`dt` is already a name of the tick"},
      {[](EquationModelText& m) { m.parameters[1].text = "V_reset"; }, Code::CircularParameter, "V_reset",
       "`E_L` depends on itself"},
      {[](EquationModelText& m) { m.parameters[1].text = "-70 mX"; }, Code::Expression, "mX", "unknown unit `mX`"},
      {[](EquationModelText& m) { m.equations[0].text = "(E_L - v) ^ 2 / 1 mV / tau_m"; }, Code::MethodNeeded,
       "(E_L - v) ^ 2", "not linear in the states, so the equations cannot be integrated exactly"},
      {[](EquationModelText& m) {
         m.method = EquationMethod::Exact;
         m.equations[0].text = "(E_L - v) * v / 1 mV / tau_m";
       },
       Code::NotLinear, "(E_L - v) * v", "not linear in the states, which exact integration needs"},
      {[](EquationModelText& m) {
         m.method = EquationMethod::ExponentialEuler;
         m.equations[0].text = "exp(v / 1 mV) * 1 mV / tau_m";
       },
       Code::NotLinear, "exp(v / 1 mV)", "not linear in `v`, which exponential Euler needs"},
      {[](EquationModelText& m) { m.equations[0].text = "(E_L - v) / (tau_m - 20 ms)"; }, Code::Expression,
       "1 / (tau_m - 20 ms)", ""},
      {[](EquationModelText& m) { m.equations[1].text = "I / 1e-9 ms"; }, Code::Expression, "I / 1e-9 ms",
       "grows beyond the range of numbers within one tick"},
  };
  for (const Row& row : rows) {
    EquationModelText text = lif();
    row.spoil(text);
    CAPTURE(row.marked);
    CAPTURE(row.message);
    const std::vector<Found> found = errors_of(text);
    REQUIRE(found.size() >= 1);
    CHECK(found[0].code == row.code);
    if (!row.message.empty()) {
      CHECK(found.size() == 1);
      CHECK(found[0].marked == row.marked);
      CHECK(found[0].message == row.message);
    }
  }
}

TEST_CASE("several mistakes are all found, and no consequences") {
  EquationModelText text = lif();
  text.equations[0].text = "(E_L - u) / tau_m + ln(I)";
  text.threshold = "v > 3";
  text.reset[0].text = "V_rest";
  const std::vector<Found> found = errors_of(text);
  REQUIRE(found.size() == 4);
  CHECK(found[0].marked == "u");
  CHECK(found[1].marked == "I");
  CHECK(found[2].marked == "3");
  CHECK(found[3].marked == "V_rest");

  EquationModelText parameters = lif();
  parameters.parameters[1].text = "-70 mV + 1 nA";  // V_reset uses it
  CHECK(errors_of(parameters).size() == 1);
}

TEST_CASE("circuit parameters are in scope") {
  EquationModelText text = lif();
  text.equations[2].text = "I + ex * (g / 1 nA)";
  CHECK(errors_of(text).empty());
}

TEST_CASE("parameters may be written in any order, and values reach those that depend on them") {
  EquationModelText text = lif();
  text.parameters = {
      {"V_reset", "E_L + 5 mV"}, {"E_L", "-70 mV"}, {"tau_m", "20 ms"}, {"V_th", "-50 mV"}, {"R_m", "10 MOhm"}};
  std::vector<EquationError> errors;
  const auto model = check_equation_model(text, circuit(), errors);
  REQUIRE(model);
  CHECK(model->parameter_dimension("V_reset") == kVoltage);
  CHECK_FALSE(model->parameter_dimension("nope"));
  const auto program = compile_equations(*model, {{"E_L", {-60}}}, 1, 0.1, errors);
  REQUIRE(program);
  CHECK(std::find(program->constants.begin(), program->constants.end(), -55) != program->constants.end());
}

TEST_CASE("a value that varies becomes a column, and only what depends on it") {
  std::vector<EquationError> errors;
  const auto model = check_equation_model(lif(), circuit(), errors);
  REQUIRE(model);
  const auto thresholds = compile_equations(*model, {{"V_th", {-50, -51, -52}}}, 3, 0.1, errors);
  REQUIRE(thresholds);
  REQUIRE(thresholds->columns.size() == 1);
  CHECK(thresholds->columns[0] == std::vector<double>{-50, -51, -52});
  // E_L: its own initial value, the reset, and the constant part of the propagated v.
  const auto leaks = compile_equations(*model, {{"E_L", {-70, -71, -72}}}, 3, 0.1, errors);
  REQUIRE(leaks);
  CHECK(leaks->columns.size() == 3);
  // tau_m: each neuron has its own propagators.
  const auto speeds = compile_equations(*model, {{"tau_m", {10, 20, 30}}}, 3, 0.1, errors);
  REQUIRE(speeds);
  bool has_decay = false;
  for (const auto& column : speeds->columns) {
    has_decay = has_decay || std::abs(column[1] - std::exp(-0.1 / 20)) < 1e-15;
  }
  CHECK(has_decay);
  // Values that are all the same are one value.
  CHECK(compile_equations(*model, {{"V_th", {-50, -50, -50}}}, 3, 0.1, errors)->columns.empty());
  CHECK(errors.empty());
}

TEST_CASE("an expression splits into slopes and offset by its form") {
  const auto split = [](std::string_view text) {
    std::vector<ExprError> errors;
    const auto expression = parse_expression(text, errors);
    REQUIRE(expression);
    return split_linear(*expression, 2, [](std::string_view name) -> std::optional<std::size_t> {
      return name == "x" ? std::optional<std::size_t>(0) : name == "y" ? std::optional<std::size_t>(1) : std::nullopt;
    });
  };
  Environment e;
  e.add_constant("k", {3, kNumber});
  const auto value = [&](const std::optional<Expression>& part) {
    if (!part) {
      return 0.0;
    }
    std::vector<ExprError> errors;
    const auto typed = type_expression(*part, e, errors);
    REQUIRE(typed);
    return typed->constant.value();
  };
  const LinearSplit a = split("(4 - x + k * (y - 2)) / 2 - -y");
  CHECK(value(a.slopes[0]) == -0.5);
  CHECK(value(a.slopes[1]) == 2.5);
  CHECK(value(a.offset) == -1);
  const LinearSplit b = split("if(k > 2, x, 5) + (k > 2 ? 1 : y)");
  CHECK(value(b.slopes[0]) == 1);
  CHECK(value(b.slopes[1]) == 0);
  CHECK(value(b.offset) == 1);
  CHECK_FALSE(split("7").slopes[0]);
  for (const char* text : {"x * x", "1 / x", "exp(x)", "x ^ 2", "x > 0 ? 1 : 2", "min(x, 1)", "x * y", "abs(x) + 1"}) {
    CAPTURE(text);
    CHECK(split(text).nonlinear);
  }
  std::string sum = "x";
  for (int i = 0; i < 5000; ++i) {
    sum += "+x";
  }
  CHECK(value(split(sum).slopes[0]) == 5001);
}

TEST_CASE("the matrix exponential agrees with closed forms") {
  SquareMatrix rotation(2);
  rotation.at(0, 1) = -30;
  rotation.at(1, 0) = 30;
  const SquareMatrix turned = matrix_exponential(rotation);
  CHECK(turned.at(0, 0) == doctest::Approx(std::cos(30.0)).epsilon(1e-12));
  CHECK(turned.at(1, 0) == doctest::Approx(std::sin(30.0)).epsilon(1e-12));

  SquareMatrix jordan(3);  // e^(-2 t) times 1, t, t^2/2
  for (std::size_t i = 0; i < 3; ++i) {
    jordan.at(i, i) = -2;
  }
  jordan.at(0, 1) = jordan.at(1, 2) = 1;
  const Propagators step = propagators(jordan, 0.3);
  CHECK(step.state.at(0, 0) == doctest::Approx(std::exp(-0.6)).epsilon(1e-15));
  CHECK(step.state.at(0, 1) == doctest::Approx(0.3 * std::exp(-0.6)).epsilon(1e-15));
  CHECK(step.state.at(0, 2) == doctest::Approx(0.045 * std::exp(-0.6)).epsilon(1e-15));
  CHECK(step.input.at(0, 0) == doctest::Approx((1 - std::exp(-0.6)) / 2).epsilon(1e-15));

  SquareMatrix stiff(2);  // time constants of 1e-3 and 1e4 ticks
  stiff.at(0, 0) = -1000;
  stiff.at(1, 1) = -1e-4;
  const Propagators fast = propagators(stiff, 1);
  CHECK(std::abs(fast.state.at(0, 0)) < 1e-12);
  CHECK(fast.input.at(0, 0) == doctest::Approx(1e-3).epsilon(1e-12));
  CHECK(fast.state.at(1, 1) == doctest::Approx(std::exp(-1e-4)).epsilon(1e-13));

  SquareMatrix broken(1);
  broken.at(0, 0) = INFINITY;
  CHECK(std::isnan(matrix_exponential(broken).at(0, 0)));
}
