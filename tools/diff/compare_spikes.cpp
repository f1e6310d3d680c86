#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "tools/analysis/spike_times.h"
#include "tools/analysis/statistics.h"
#include "tools/diff/behaviour.h"
#include "tools/diff/spike_distance.h"
#include "tools/evaluate/parallel_jobs.h"

namespace tectum {
namespace {

constexpr double kVanRossumTauMs = 10;
constexpr double kVictorPurpuraPerMs = 0.1;
constexpr std::size_t kMostNeurons = 16;
constexpr double kSmoothingMs = 3;
constexpr int kLongestLagMs = 40;
constexpr std::size_t kBeforeJumpMs = 50;
constexpr double kLeastAnswerHz = 10;

/// Spike times of a recording, neuron by neuron.
class Trains {
 public:
  explicit Trains(const Recording& recording) : recording_(recording) {
    std::uint32_t neurons = 0;
    for (const RecordedPopulation& population : recording.populations) {
      neurons = std::max(neurons, population.first_neuron + population.size);
    }
    first_.resize(neurons + 1);
    for (const RecordedSpike& spike : recording.spikes) {
      if (spike.neuron < neurons) {
        ++first_[spike.neuron + 1];
      }
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    times_ms_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end());
    SpikeClock clock(recording);
    std::optional<std::uint64_t> tick;
    double now_ms = 0;
    for (const RecordedSpike& spike : recording.spikes) {
      if (tick != spike.tick) {
        tick = spike.tick;
        now_ms = clock.time_s(spike.tick) * 1e3;
      }
      if (spike.neuron < neurons) {
        times_ms_[next[spike.neuron]++] = now_ms;
      }
    }
  }
  [[nodiscard]] std::span<const double> of(std::size_t population, std::uint32_t index) const {
    return of_neurons(recording_.populations[population].first_neuron + index, 1);
  }
  /// Of all neurons of a population, one neuron after the other.
  [[nodiscard]] std::span<const double> of(std::size_t population) const {
    return of_neurons(recording_.populations[population].first_neuron, size(population));
  }
  [[nodiscard]] std::uint32_t size(std::size_t population) const { return recording_.populations[population].size; }
  [[nodiscard]] double rate_hz(std::size_t population) const {
    return size(population) == 0 || recording_.duration_s <= 0
               ? 0
               : static_cast<double>(of(population).size()) / size(population) / recording_.duration_s;
  }
  [[nodiscard]] double end_ms() const { return recording_.duration_s * 1e3; }

  /// Spikes a ms, smoothed.
  [[nodiscard]] std::vector<double> profile(std::size_t population) const {
    std::vector<double> counts(static_cast<std::size_t>(std::max(1.0, end_ms())) + 1, 0.0);
    for (const double t_ms : of(population)) {
      counts[std::min(static_cast<std::size_t>(std::max(0.0, t_ms)), counts.size() - 1)] += 1;
    }
    std::vector<double> smooth(counts.size(), 0.0);
    const int reach = static_cast<int>(3 * kSmoothingMs);
    for (int shift = -reach; shift <= reach; ++shift) {
      const double weight = std::exp(-0.5 * shift * shift / (kSmoothingMs * kSmoothingMs));
      for (std::size_t k = 0; k < counts.size(); ++k) {
        const auto from = static_cast<std::ptrdiff_t>(k) + shift;
        if (from >= 0 && from < static_cast<std::ptrdiff_t>(counts.size())) {
          smooth[k] += weight * counts[static_cast<std::size_t>(from)];
        }
      }
    }
    const double middle = mean(smooth);
    for (double& value : smooth) {
      value -= middle;
    }
    return smooth;
  }

 private:
  [[nodiscard]] std::span<const double> of_neurons(std::uint32_t neuron, std::uint32_t count) const {
    return std::span(times_ms_).subspan(first_[neuron], first_[neuron + count] - first_[neuron]);
  }

  const Recording& recording_;
  std::vector<std::size_t> first_;  // of each neuron in times_ms_, and the end
  std::vector<double> times_ms_;
};

std::optional<double> lag_ms(const std::vector<double>& a, const std::vector<double>& b) {
  const auto length = static_cast<int>(std::min(a.size(), b.size()));
  double best = 0;
  std::optional<double> lag;
  // From the smallest shift outwards, so that of equals the smallest wins.
  for (int step = 0; step <= 2 * kLongestLagMs; ++step) {
    const int shift = (step + 1) / 2 * (step % 2 == 0 ? -1 : 1);
    double product = 0;
    for (int k = std::max(0, -shift); k < std::min(length, length - shift); ++k) {
      product += a[static_cast<std::size_t>(k)] * b[static_cast<std::size_t>(k + shift)];
    }
    if (product > best * (1 + 1e-9)) {
      best = product;
      lag = shift;
    }
  }
  return lag;
}

/// When a rate has done half of its way from before the jump to its farthest after it, and whether that is up or down.
struct Answer {
  double latency_ms = 0;
  bool is_up = true;
};

/// Nothing where the rate stays within what it does without a jump.
std::optional<Answer> answer(const std::vector<double>& profile, std::uint32_t neurons, const RunPart& part,
                             std::optional<bool> must_be_up) {
  const auto begin = static_cast<std::size_t>(part.begin_s * 1e3), end = static_cast<std::size_t>(part.end_s * 1e3);
  if (begin < kBeforeJumpMs || end > profile.size() || end <= begin) {
    return std::nullopt;
  }
  const std::span<const double> before(profile.data() + begin - kBeforeJumpMs, kBeforeJumpMs);
  const std::span<const double> after(profile.data() + begin, end - begin);
  const double rest = mean(before);
  const auto [low, high] = std::minmax_element(after.begin(), after.end());
  const auto [rest_low, rest_high] = std::minmax_element(before.begin(), before.end());
  const double up = *high - rest, down = rest - *low;
  const bool is_up = must_be_up.value_or(up >= down);
  const double noise = 2 * std::max(*rest_high - rest, rest - *rest_low);
  const double way = is_up ? up : down;
  if (way <= noise || way * 1e3 / neurons < kLeastAnswerHz) {
    return std::nullopt;
  }
  const auto half = std::find_if(after.begin(), after.end(),
                                 [&](double value) { return (is_up ? value - rest : rest - value) >= way / 2; });
  return Answer{static_cast<double>(half - after.begin()), is_up};
}

void latencies(const std::vector<double>& a, const std::vector<double>& b, std::uint32_t neurons,
               const std::vector<RunPart>& parts, PairedFigure& latency) {
  std::vector<double> first_ms, second_ms;
  for (const RunPart& part : parts) {
    if (part.kind != PartKind::Step) {
      continue;
    }
    const std::optional<Answer> x = answer(a, neurons, part, std::nullopt);
    const std::optional<Answer> y = x ? answer(b, neurons, part, x->is_up) : std::nullopt;
    if (y) {
      first_ms.push_back(x->latency_ms);
      second_ms.push_back(y->latency_ms);
    }
  }
  if (!first_ms.empty()) {
    latency.a.push_back(mean(first_ms));
    latency.b.push_back(mean(second_ms));
  }
}

void distances(const Trains& a, std::size_t p, const Trains& b, std::size_t q, PopulationDifference& difference) {
  std::vector<std::uint32_t> firing;
  for (std::uint32_t i = 0; i < std::min(a.size(p), b.size(q)); ++i) {
    if (!a.of(p, i).empty() || !b.of(q, i).empty()) {
      firing.push_back(i);
    }
  }
  const std::size_t count = std::min(firing.size(), kMostNeurons);
  const double end_ms = std::max({a.end_ms(), b.end_ms(), 1.0});
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = firing[k * firing.size() / count];
    const std::span<const double> x = a.of(p, i), y = b.of(q, i);
    const auto share = 1 / static_cast<double>(count);
    difference.van_rossum += share * van_rossum_distance(x, y, kVanRossumTauMs);
    difference.victor_purpura += share * victor_purpura_distance(x, y, kVictorPurpuraPerMs);
    difference.spike += share * spike_distance(x, y, 0, end_ms);
  }
}

bool is_same_population(const Trains& a, std::size_t p, const Trains& b, std::size_t q) {
  const auto is_same = [](std::span<const double> x, std::span<const double> y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end());
  };
  if (a.size(p) != b.size(q) || !is_same(a.of(p), b.of(q))) {
    return false;
  }
  for (std::uint32_t i = 0; i < a.size(p); ++i) {
    if (!is_same(a.of(p, i), b.of(q, i))) {
      return false;
    }
  }
  return true;
}

/// The trains of a seed.
struct TrainPair {
  std::optional<Trains> a, b;
  const std::vector<RunPart>& parts;
};

/// Of population p of the first circuits and q of the second ones; nothing when they do the same in every seed.
std::optional<PopulationDifference> difference_of(const std::vector<TrainPair>& seeds, std::size_t p, std::size_t q) {
  const bool is_same = std::all_of(seeds.begin(), seeds.end(),
                                   [&](const TrainPair& seed) { return is_same_population(*seed.a, p, *seed.b, q); });
  if (is_same) {
    return std::nullopt;
  }
  PopulationDifference difference;
  difference.rate = {"rate", "Hz", {}, {}};
  difference.latency = {"latency", "ms", {}, {}};
  for (const TrainPair& seed : seeds) {
    difference.rate.a.push_back(seed.a->rate_hz(p));
    difference.rate.b.push_back(seed.b->rate_hz(q));
    const std::vector<double> profile_a = seed.a->profile(p), profile_b = seed.b->profile(q);
    latencies(profile_a, profile_b, std::max(seed.a->size(p), seed.b->size(q)), seed.parts, difference.latency);
    if (&seed == seeds.data()) {
      difference.lag_ms = lag_ms(profile_a, profile_b);
    }
  }
  distances(*seeds[0].a, p, *seeds[0].b, q, difference);
  return difference;
}

}  // namespace

std::vector<PopulationDifference> compare_spikes(const std::vector<RecordingPair>& pairs,
                                                 const std::vector<std::uint32_t>& population_of_b, unsigned threads) {
  std::vector<TrainPair> seeds;
  std::vector<Job> jobs;
  for (const RecordingPair& pair : pairs) {
    seeds.push_back({{}, {}, pair.parts});
  }
  for (std::size_t s = 0; s < pairs.size(); ++s) {
    jobs.emplace_back([&, s](const auto&) { seeds[s].a.emplace(pairs[s].a); });
    jobs.emplace_back([&, s](const auto&) { seeds[s].b.emplace(pairs[s].b); });
  }
  run_jobs(jobs, threads, {});

  std::vector<std::optional<PopulationDifference>> differences(population_of_b.size());
  jobs.clear();
  for (std::size_t q = 0; q < population_of_b.size(); ++q) {
    if (population_of_b[q] != kNoMatch) {
      jobs.emplace_back([&, q](const auto&) { differences[q] = difference_of(seeds, population_of_b[q], q); });
    }
  }
  run_jobs(jobs, threads, {});

  std::vector<PopulationDifference> found;
  for (std::size_t q = 0; q < differences.size(); ++q) {
    if (differences[q]) {
      found.push_back(std::move(*differences[q]));
      found.back().name = pairs.front().b.populations[q].name;
    }
  }
  return found;
}

}  // namespace tectum
