#include "tools/evaluate/physiology.h"

#include <doctest/doctest.h>

#include "tests/eval/evaluated_circuit.h"

using namespace tectum;

TEST_CASE("a yardstick that could not be measured does not pass") {
  Yardstick yardstick{.what = "rate", .unit = "sp/s", .value = {}, .low = 0, .high = 10, .source = ""};
  CHECK_FALSE(yardstick.passes());
  yardstick.value = 10;
  CHECK(yardstick.passes());
  yardstick.value = 10.1;
  CHECK_FALSE(yardstick.passes());
}

TEST_CASE("yardsticks are the same for any number of threads") {
  Protocol protocol = shipped_protocol("physiology");
  protocol.trials = 2;
  protocol.duration_s = 6;
  const auto one = physiology(oculomotor_image(), protocol, 1, nullptr);
  const auto two = physiology(oculomotor_image(), protocol, 2, nullptr);
  CHECK(physiology_json(protocol, "c", one) == physiology_json(protocol, "c", two));
  CHECK(one.size() == 20);
}
