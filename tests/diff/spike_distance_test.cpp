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
  // One spike at 4 against one at 6 in [0, 10): each is 2 ms from the other, all the time.
  //   [0, 4): intervals 4 and 6: (2 * 6 + 2 * 4) / (2 * 5^2) = 0.4;  [4, 6): both 6: 24 / 72;  [6, 10): as the first
  CHECK(is_near(spike_distance(Times{4}, Times{6}, 0, 10), (8 * 0.4 + 2 / 3.0) / 10));
  CHECK(is_near(spike_distance(Times{4}, Times{6}, 0, 10), spike_distance(Times{6}, Times{4}, 0, 10)));
  // One at 5 against none, which counts as one at each end: 5 ms away, intervals 5 and 10: 5 * 10 / (2 * 7.5^2).
  CHECK(is_near(spike_distance(Times{5}, Times{}, 0, 10), 50.0 / 112.5));
}

// Values that the authors of SPIKY and PySpike give: github.com/mariomulansky/PySpike, test/test_distance.py.
TEST_CASE("SPIKE: the published examples of SPIKY and PySpike") {
  CHECK(is_near(spike_distance(Times{0, 2, 5, 8}, Times{0, 1, 5, 9}, 0, 10), 0.186309523809523814));
  Times every_100, every_110;
  for (int t = 100; t < 1201; t += 100) {
    every_100.push_back(t);
  }
  for (int t = 100; t < 1201; t += 110) {
    every_110.push_back(t);
  }
  CHECK(is_near(spike_distance(every_100, every_110, 0, 1300), 0.211058782487353908));
  // Before and after all spikes of one train: the profile at both ends of each piece.
  const Times ends = {0, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6};
  const std::vector<double> profile = {0.271604938271605, 0.271604938271605, 0.271604938271605, 0.617283950617284,
                                       0.617283950617284, 0.444444444444444, 0.285714285714286, 0.285714285714286,
                                       0.444444444444444, 0.617283950617284, 0.617283950617284, 0.271604938271605,
                                       0.271604938271605, 0.271604938271605};
  double area = 0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    area += (profile[2 * k] + profile[2 * k + 1]) / 2 * (ends[k + 1] - ends[k]);
  }
  CHECK(is_near(spike_distance(Times{0.5, 1.5, 2.5}, Times{3.5, 4.5, 5.5}, 0, 6), area / 6));
}

// The trains and values of Elephant: github.com/NeuralEnsemble/elephant, test/test_spike_train_dissimilarity.py and
// the docstrings of spike_train_dissimilarity.py. Its van Rossum distance makes a lone spike 1, which is ours by
// sqrt 2.
TEST_CASE("van Rossum, Victor and Purpura: the published examples of Elephant") {
  CHECK(is_near(victor_purpura_distance(Times{1}, Times{2.9}, 1), 1.9));
  CHECK(is_near(victor_purpura_distance(Times{1}, Times{3.1}, 1), 2));
  CHECK(is_near(victor_purpura_distance(Times{12, 32}, Times{32, 52}, 0.01), 0.4));
  CHECK(is_near(victor_purpura_distance(Times{12, 32}, Times{18, 60}, 0.1), 2.6));
  CHECK(is_near(victor_purpura_distance(Times{10, 20, 30, 40}, Times{10, 20, 30, 40, 50}, 1), 1));
  CHECK(is_near(victor_purpura_distance(Times{12}, Times{20, 20}, 0.1), 1.8));
  CHECK(is_near(victor_purpura_distance(Times{10, 20, 30}, Times{12, 24, 30}, 0.1), 0.6));
  const auto elephant = [](const Times& a, const Times& b, double tau_ms) {
    return std::sqrt(2.0) * van_rossum_distance(a, b, tau_ms);
  };
  CHECK(is_near(elephant(Times{10, 20, 30, 40}, Times{10, 20, 30, 40, 50}, 1e-9), 1));
  CHECK(is_near(elephant(Times{12, 32}, Times{10, 20, 30, 40}, 1e-9), std::sqrt(6.0)));
  CHECK(is_near(elephant(Times{12, 32}, Times{10, 20, 30, 40, 50}, 1e-9), std::sqrt(7.0)));
  CHECK(is_near(elephant(Times{}, Times{1}, 1), 1));
  CHECK(is_near(elephant(Times{1}, Times{2}, 1), std::sqrt(2 * (1 - std::exp(-1.0)))));
  CHECK(is_near(elephant(Times{12, 32}, Times{32, 52}, 100), std::sqrt(2 * (1 - std::exp(-0.4)))));
}
