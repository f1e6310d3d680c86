// Several circuits in one evaluation.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tools/evaluate/evaluation_text.h"

using namespace tectum;

namespace {

CircuitEvaluation evaluation(const std::string& name, double rmse_deg) {
  CircuitEvaluation made{name, {}};
  SettingResult& setting = made.evaluation.settings.emplace_back();
  setting.setting.hold_s = 1;
  setting.controllers[0].all.rmse_deg = rmse_deg;
  setting.controllers[1].all.rmse_deg = 2;
  setting.controllers[2].all.rmse_deg = 3;
  return made;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++found;
  }
  return found;
}

}  // namespace

TEST_CASE("several circuits are lines of one table, beside one oracle and one PID servo") {
  Protocol protocol;
  protocol.name = "made";
  protocol.scenario.kind = ScenarioKind::Circle;
  const std::vector<CircuitEvaluation> circuits = {evaluation("first", 4), evaluation("a_longer_name", 5)};
  const std::string text = tracking_text(protocol, circuits);
  CHECK(count(text, "\n  first ") == 1);
  CHECK(count(text, "\n  a_longer_name ") == 1);
  CHECK(count(text, "\n  oracle ") == 1);
  CHECK(count(text, "\n  pid ") == 1);
  CHECK(count(text, "\n  circuit ") == 0);
}

TEST_CASE("a circuit alone is called the circuit") {
  Protocol protocol;
  protocol.scenario.kind = ScenarioKind::Circle;
  const std::vector<CircuitEvaluation> one = {evaluation("first", 4)};
  CHECK(count(tracking_text(protocol, one), "\n  circuit ") == 1);
}
