#include "tools/analysis/population_rates.h"

#include <doctest/doctest.h>

#include "tools/analysis/spike_times.h"

namespace tectum {
namespace {

/// Two populations of 2 and 1 neurons; 1 ms ticks, frames every 10 ticks, 100 ms long.
Recording two_populations() {
  Recording recording;
  recording.tick_ns = 1'000'000;
  recording.frame_period_ns = 10'000'000;
  recording.populations = {{"A", "SC", 0, 2}, {"B", "PPRF", 2, 1}};
  for (int k = 0; k < 10; ++k) {
    RecordedFrame frame;
    frame.tick = static_cast<std::uint64_t>(k) * 10;
    frame.time_ns = k * 10'000'000;
    recording.frames.push_back(frame);
  }
  recording.spikes = {{0, 0}, {0, 2}, {19, 1}, {20, 0}, {99, 0}};
  return recording;
}

TEST_CASE("a rate is spikes by neuron and bin width, bins half-open") {
  const std::vector<PopulationRate> rates = population_rates(two_populations(), {0, 0.1, 0.02});
  REQUIRE(rates.size() == 2);
  REQUIRE(rates[0].rate_hz.size() == 5);
  CHECK(rates[0].rate_hz[0] == doctest::Approx(2 / (2 * 0.02)));  // ticks 0 and 19
  CHECK(rates[0].rate_hz[1] == doctest::Approx(1 / (2 * 0.02)));  // tick 20 starts the second bin
  CHECK(rates[0].rate_hz[4] == doctest::Approx(1 / (2 * 0.02)));
  CHECK(rates[1].rate_hz[0] == doctest::Approx(1 / 0.02));
}

TEST_CASE("a last bin that is cut short is scaled to its width") {
  const std::vector<PopulationRate> rates = population_rates(two_populations(), {0.08, 0.1, 0.015});
  REQUIRE(rates[0].rate_hz.size() == 2);
  CHECK(rates[0].rate_hz[1] == doctest::Approx(1 / (2 * 0.005)));
}

TEST_CASE("summaries count spikes, mean and peak rate and who fired") {
  const std::vector<PopulationSummary> summaries = population_summaries(two_populations());
  CHECK(summaries[0].spikes == 4);
  CHECK(summaries[0].mean_rate_hz == doctest::Approx(4 / 2 / 0.1));
  CHECK(summaries[0].peak_rate_hz == doctest::Approx(50));
  CHECK(summaries[0].active_share == doctest::Approx(1));
  CHECK(summaries[1].spikes == 1);
}

TEST_CASE("spikes are timed from their frame, so uneven frame periods do not drift") {
  Recording recording = two_populations();
  recording.frames[9].time_ns += 500'000;
  const std::vector<double> times_s = spike_times_s(recording);
  CHECK(times_s[3] == doctest::Approx(0.020));
  CHECK(times_s[4] == doctest::Approx(0.0995));
}

TEST_CASE("the spikes of a window are half-open at its ends") {
  const Recording recording = two_populations();
  CHECK(spikes_between(recording, 0, 0.1).size() == 5);
  CHECK(spikes_between(recording, 0.019, 0.099).size() == 2);
  CHECK(spikes_between(recording, 0.02, 0.0991).size() == 2);
  CHECK(spikes_between(recording, 0.5, 0.1).empty());
  CHECK(spikes_between(Recording{}, 0, 1).empty());
}

TEST_CASE("a clock asked for ticks in any order gives the same times") {
  Recording recording = two_populations();
  recording.frames[5].time_ns += 3'000'000;
  SpikeClock clock(recording);
  CHECK(clock.time_s(55) == doctest::Approx(0.058));
  CHECK(clock.time_s(5) == doctest::Approx(0.005));
  CHECK(clock.time_s(95) == doctest::Approx(0.095));
}

TEST_CASE("a spike of a neuron that no population holds is passed over") {
  Recording recording = two_populations();
  recording.spikes.push_back({99, 1000});
  CHECK(population_summaries(recording)[0].spikes == 4);
  CHECK_FALSE(population_of(recording, 1000).has_value());
  CHECK(population_of(recording, 2).value() == 1);
}

TEST_CASE("an empty recording has no rates") {
  CHECK(population_rates(Recording{}, {}).empty());
  CHECK(population_summaries(Recording{}).empty());
}

}  // namespace
}  // namespace tectum
