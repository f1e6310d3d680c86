#include "tools/circuit_tests/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/spike_times.h"
#include "tools/circuit_tests/golden_raster.h"

namespace tectum {
namespace {

constexpr double kRunAwayDeg = 5;

std::vector<std::size_t> chosen(const Expectation& expectation, const std::vector<std::string>& names) {
  std::vector<std::size_t> found;
  for (const std::string& name : expectation.populations) {
    const std::vector<std::size_t> of_name = populations_named(names, name);
    found.insert(found.end(), of_name.begin(), of_name.end());
  }
  if (expectation.populations.empty()) {
    found.resize(names.size());
    std::iota(found.begin(), found.end(), std::size_t{0});
  }
  return found;
}

SeedOutcome of_number(const Expectation& expectation, const std::optional<double>& value, const char* otherwise) {
  SeedOutcome outcome;
  outcome.value = value;
  outcome.passes = value && expectation.bound.holds(*value);
  outcome.seen = value ? seen_text(*value, expectation.dimension, expectation.is_share) : otherwise;
  return outcome;
}

SeedOutcome of_measure(const Expectation& expectation, RunFacts& facts) {
  const Measure& measure = measures()[expectation.measure];
  const bool has_saccade = std::string_view(measure.section) == "saccade";
  return of_number(expectation, measure.of(facts, expectation.channel),
                   has_saccade ? "absent: no saccade follows a jump of the target" : "absent: nothing tells the error");
}

SeedOutcome of_rate(const Expectation& expectation, const JudgedRun& run) {
  const std::optional<double> rate_hz =
      run.facts.rate_hz(populations_named(run.names, expectation.population), expectation.time);
  return of_number(
      expectation, rate_hz ? std::optional(from_hz(*rate_hz)) : std::nullopt,
      expectation.time == RateTime::Saccades ? "absent: the run has no saccade" : "absent: there is no such time");
}

SeedOutcome of_silence(const Expectation& expectation, const JudgedRun& run) {
  const Recording& recording = run.facts.recording();
  const std::vector<std::size_t> populations = populations_named(run.names, expectation.population);
  const std::vector<std::uint32_t> population_of = population_of_neurons(recording);
  std::size_t spikes = 0;
  std::uint64_t first_tick = 0;
  for (const RecordedSpike& spike : spikes_between(recording, run.facts.settle_s(), recording.duration_s)) {
    if (std::count(populations.begin(), populations.end(), population_of[spike.neuron]) > 0) {
      first_tick = spikes == 0 ? spike.tick : first_tick;
      ++spikes;
    }
  }
  SeedOutcome outcome;
  outcome.passes = spikes == 0;
  outcome.seen = spikes == 0 ? "none"
                             : fmt::format("{}, the first at {:.4g} s", spikes,
                                           static_cast<double>(first_tick * recording.tick_ns) * 1e-9);
  return outcome;
}

SeedOutcome of_running_away(RunFacts& facts) {
  SeedOutcome outcome;
  const std::vector<RecordedFrame>& frames = facts.recording().frames;
  if (frames.empty() || !frames.back().has_truth) {
    outcome.seen = "absent: nothing tells the error";
    return outcome;
  }
  const auto error_deg = [](const RecordedFrame& frame) {
    double least = 1e9;  // both eyes have to be gone
    for (const EyeTruth& eye : frame.eye) {
      least = std::min(least, std::hypot(eye.error_pan_deg, eye.error_tilt_deg));
    }
    return least;
  };
  const double begin_deg = error_deg(frames.front()), end_deg = error_deg(frames.back());
  outcome.passes = end_deg > begin_deg + kRunAwayDeg;
  outcome.seen = fmt::format("an error of {:.3g} deg at the end after {:.3g} deg at the beginning", end_deg, begin_deg);
  return outcome;
}

SeedOutcome of_raster(const Expectation& expectation, const JudgedRun& run) {
  const double end_s = expectation.end_s > 0 ? expectation.end_s : run.facts.recording().duration_s;
  const std::string now =
      golden_raster(run.facts.recording(), {chosen(expectation, run.names), expectation.begin_s, end_s}, run.world);
  run.golden(now);
  SeedOutcome outcome;
  std::ifstream file(expectation.path, std::ios::binary);
  if (!file) {
    outcome.seen = fmt::format("no file {} yet; --update writes it", expectation.path);
    return outcome;
  }
  const std::string golden{std::istreambuf_iterator<char>(file), {}};
  const std::optional<RasterChange> change = compare_rasters(golden, now);
  outcome.passes = !change;
  outcome.seen = change ? change_text(*change) : "the same spikes";
  return outcome;
}

SeedOutcome of_spikes_alike(const Recording& mine, const Recording& other) {
  SeedOutcome outcome;
  const auto [a, b] = std::mismatch(mine.spikes.begin(), mine.spikes.end(), other.spikes.begin(), other.spikes.end());
  outcome.passes = a == mine.spikes.end() && b == other.spikes.end();
  outcome.seen = "the same spikes";
  if (!outcome.passes) {
    const bool is_mine =
        b == other.spikes.end() ||
        (a != mine.spikes.end() && (a->tick < b->tick || (a->tick == b->tick && a->neuron < b->neuron)));
    const RecordedSpike& spike = is_mine ? *a : *b;
    const Recording& recording = is_mine ? mine : other;
    const RecordedPopulation& population = recording.populations[population_of_neurons(recording)[spike.neuron]];
    outcome.seen = fmt::format("the first at {:.6g} ms, where {}[{}] fires {}",
                               static_cast<double>(spike.tick * recording.tick_ns) * 1e-6, population.name,
                               spike.neuron - population.first_neuron, is_mine ? "here alone" : "there alone");
  }
  return outcome;
}

SeedOutcome of_gaze_alike(const Expectation& expectation, const Recording& mine, const Recording& other) {
  double squares = 0, most_deg = 0, most_at_s = 0;
  std::size_t count = 0;
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const AngleTrace a = gaze_trace(mine, eye), b = gaze_trace(other, eye);
    for (std::size_t k = 0; k < std::min(a.time_s.size(), b.time_s.size()); ++k) {
      const double apart_deg = std::hypot(a.pan_deg[k] - b.pan_deg[k], a.tilt_deg[k] - b.tilt_deg[k]);
      squares += apart_deg * apart_deg;
      ++count;
      if (apart_deg > most_deg) {
        most_deg = apart_deg;
        most_at_s = a.time_s[k];
      }
    }
  }
  const double rms_deg = count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
  SeedOutcome outcome = of_number(expectation, expectation.is_rms ? rms_deg : most_deg, "");
  outcome.seen += expectation.is_rms ? fmt::format(" rms, at most {:.3g} deg at {:.4g} s", most_deg, most_at_s)
                                     : fmt::format(" at {:.4g} s, {:.3g} deg rms", most_at_s, rms_deg);
  return outcome;
}

}  // namespace

SeedOutcome judge(const Expectation& expectation, const JudgedRun& run) {
  switch (expectation.kind) {
    case ExpectationKind::Measure:
      return of_measure(expectation, run.facts);
    case ExpectationKind::Rate:
      return of_rate(expectation, run);
    case ExpectationKind::Silent:
      return of_silence(expectation, run);
    case ExpectationKind::RunAway:
      return of_running_away(run.facts);
    case ExpectationKind::Raster:
      return of_raster(expectation, run);
    case ExpectationKind::SameAs:
      break;
  }
  const Recording& other = run.other(expectation.path);
  return expectation.is_exact ? of_spikes_alike(run.facts.recording(), other)
                              : of_gaze_alike(expectation, run.facts.recording(), other);
}

ExpectationResult conclude(const Expectation& expectation, Quantifier quantifier, std::vector<SeedOutcome> seeds) {
  ExpectationResult result;
  const auto passed = static_cast<std::size_t>(
      std::count_if(seeds.begin(), seeds.end(), [](const SeedOutcome& seed) { return seed.passes; }));
  const bool has_values =
      std::all_of(seeds.begin(), seeds.end(), [](const SeedOutcome& seed) { return seed.value.has_value(); });
  // How far beyond the bound; what has no number misses by most.
  const auto miss = [&](const SeedOutcome& seed) {
    return seed.passes  ? -1
           : seed.value ? std::max(expectation.bound.low - *seed.value, *seed.value - expectation.bound.high)
                        : 1e300;
  };
  const auto worst = std::max_element(seeds.begin(), seeds.end(),
                                      [&](const SeedOutcome& a, const SeedOutcome& b) { return miss(a) < miss(b); });
  result.seen = worst->seen;
  result.shown_seed = worst->seed;
  if (quantifier == Quantifier::Mean && has_values) {
    double mean = 0;
    for (const SeedOutcome& seed : seeds) {
      mean += *seed.value / static_cast<double>(seeds.size());
    }
    result.passes = expectation.bound.holds(mean);
    result.seen = seen_text(mean, expectation.dimension, expectation.is_share);
  } else {
    result.passes = quantifier == Quantifier::Most ? 2 * passed > seeds.size() : passed == seeds.size();
  }
  result.seeds = std::move(seeds);
  return result;
}

}  // namespace tectum
