// Each distance against values worked out from its definition.
#include "tools/diff/spike_distance.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace tectum;
using Times = std::vector<double>;

namespace {
bool is_near(double value, double expected) { return std::abs(value - expected) <= 1e-9; }
}  // namespace

TEST_CASE("van Rossum: a lone spike is worth one half, two of them 1 - exp(-distance / tau)") {
  CHECK(is_near(van_rossum_distance(Times{}, Times{}, 10), 0));
  CHECK(is_near(van_rossum_distance(Times{30}, Times{}, 10), std::sqrt(0.5)));
  CHECK(is_near(van_rossum_distance(Times{30}, Times{35}, 10), std::sqrt(1 - std::exp(-0.5))));
  // Both spikes of one train: 1/2 + 1/2 + exp(-1).
  CHECK(is_near(van_rossum_distance(Times{10, 20}, Times{}, 10), std::sqrt(1 + std::exp(-1.0))));
  CHECK(is_near(van_rossum_distance(Times{10, 20}, Times{10, 20}, 10), 0));
  // (10, 20) against (15): (2 + 2 e^-1 + 1 - 2 * 2 e^-1/2) / 2.
  CHECK(is_near(van_rossum_distance(Times{10, 20}, Times{15}, 10),
                std::sqrt((3 + 2 * std::exp(-1.0) - 4 * std::exp(-0.5)) / 2)));
}

TEST_CASE("Victor and Purpura: a spike is moved while that is cheaper than taking it out and putting it in") {
  CHECK(is_near(victor_purpura_distance(Times{}, Times{1, 2, 3}, 0.1), 3));
  CHECK(is_near(victor_purpura_distance(Times{10}, Times{14}, 0.1), 0.4));
  CHECK(is_near(victor_purpura_distance(Times{10}, Times{60}, 0.1), 2));
  CHECK(is_near(victor_purpura_distance(Times{10, 50}, Times{12, 47, 90}, 0.1), 0.2 + 0.3 + 1));
  CHECK(is_near(victor_purpura_distance(Times{10, 50}, Times{12, 47, 90}, 0), 1));
}

TEST_CASE("SPIKE: the profile of two hand-drawn trains, integrated") {
  CHECK(is_near(spike_distance(Times{2, 5}, Times{2, 5}, 0, 10), 0));
  CHECK(is_near(spike_distance(Times{}, Times{}, 0, 10), 0));
  // One spike at 4 against one at 6 in [0, 10): both trains have their nearest 2 ms away.
  //   [0, 4): S_a = 2 t/4, S_b = 2 t/6; intervals 4 and 6: S(t) = (t/2 * 6 + t/3 * 4) / 50; integral 8 * 26 / 300
  //   [4, 6): S_a = 2 (10 - t)/6, S_b = 2 t/6, both intervals 6: S(t) = (S_a + S_b) * 6 / 72 = 10/36; integral 20/36
  //   [6, 10): as the first, mirrored
  CHECK(is_near(spike_distance(Times{4}, Times{6}, 0, 10), (2 * 8 * 26.0 / 300 + 20.0 / 36) / 10));
  CHECK(is_near(spike_distance(Times{4}, Times{6}, 0, 10), spike_distance(Times{6}, Times{4}, 0, 10)));
  // One at 5 against none: only the spike itself is 5 away. [0, 5): S_a = t, intervals 5 and 10:
  // S(t) = t * 10 / (2 * 7.5^2); both halves the same: 2 * 12.5 * 10 / 112.5 / 10.
  CHECK(is_near(spike_distance(Times{5}, Times{}, 0, 10), 25.0 / 112.5));
}
