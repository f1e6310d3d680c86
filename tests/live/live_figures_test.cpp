// The figures of a run on a head, as lines and as JSON.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tools/live/live_run.h"

namespace tectum {
namespace {

/// 1172 turns, of which 440 sent their command late, and 1172 periods slept through.
LiveRun overloaded_run() {
  LiveRun run;
  run.figures.loop.turns = 1172;
  run.figures.loop.skipped_periods = 1172;
  run.figures.missed_deadlines = 1612;
  run.figures.frame_to_command.add(2'000'000);
  run.figures.head.wire.requests = 31;
  run.figures.head.wire.retries = 7;
  return run;
}

TEST_CASE("missed deadlines are counted out of all periods that were due") {
  const std::string text = live_figures_text(overloaded_run());
  CHECK(text.find("missed deadlines: 1612 of 2344 periods (440 commands late, 1172 periods skipped)\n") !=
        std::string::npos);
}

TEST_CASE("the JSON figures hold latency, deadlines and the bus") {
  const nlohmann::json json = nlohmann::json::parse(live_figures_json(overloaded_run()));
  CHECK(json["deadlines"]["periods"] == 2344);
  CHECK(json["deadlines"]["missed"] == 1612);
  CHECK(json["deadlines"]["late_commands"] == 440);
  CHECK(json["deadlines"]["skipped_periods"] == 1172);
  CHECK(json["latency_ms"]["frames_to_command"]["most"] == doctest::Approx(2.0));
  CHECK(json["latency_ms"]["stages"].size() == 5);
  CHECK(json["bus"]["questions"] == 31);
  CHECK(json["bus"]["retries"] == 7);
}

}  // namespace
}  // namespace tectum
