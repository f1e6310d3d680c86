#include <doctest/doctest.h>

#include "tools/live/stolen_time.h"

using namespace tectum;

TEST_CASE("stolen time is the eighth column of the first line of /proc/stat") {
  const auto before = processor_ticks("cpu  100 0 50 800 0 0 0 50 7 7\ncpu0 1 2 3 4 5 6 7 8 9 10\n");
  const auto after = processor_ticks("cpu  140 0 70 810 0 0 0 80 9 9\n");
  REQUIRE(before);
  REQUIRE(after);
  CHECK(before->all == 1000);
  CHECK(stolen_share(*before, *after) == doctest::Approx(0.3));
  CHECK(stolen_share(*before, *before) == 0);
}

TEST_CASE("a text without stolen time gives nothing") {
  CHECK(!processor_ticks(""));
  CHECK(!processor_ticks("cpu  1 2 3 4 5 6 7\n"));
  CHECK(!processor_ticks("intr 1 2 3 4 5 6 7 8\n"));
}
