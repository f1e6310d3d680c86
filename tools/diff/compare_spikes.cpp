#include <algorithm>
#include <cmath>
#include <span>

#include "tools/analysis/spike_times.h"
#include "tools/analysis/statistics.h"
#include "tools/diff/behaviour.h"
#include "tools/diff/spike_distance.h"

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
    times_ms_.resize(neurons);
    SpikeClock clock(recording);
    for (const RecordedSpike& spike : recording.spikes) {
      if (spike.neuron < neurons) {
        times_ms_[spike.neuron].push_back(clock.time_s(spike.tick) * 1e3);
      }
    }
  }
  [[nodiscard]] const std::vector<double>& of(std::size_t population, std::uint32_t index) const {
    return times_ms_[recording_.populations[population].first_neuron + index];
  }
  [[nodiscard]] std::uint32_t size(std::size_t population) const { return recording_.populations[population].size; }
  [[nodiscard]] double rate_hz(std::size_t population) const {
    std::size_t spikes = 0;
    for (std::uint32_t i = 0; i < size(population); ++i) {
      spikes += of(population, i).size();
    }
    return size(population) == 0 || recording_.duration_s <= 0
               ? 0
               : static_cast<double>(spikes) / size(population) / recording_.duration_s;
  }
  [[nodiscard]] double end_ms() const { return recording_.duration_s * 1e3; }

  /// Spikes a ms, smoothed.
  [[nodiscard]] std::vector<double> profile(std::size_t population) const {
    std::vector<double> counts(static_cast<std::size_t>(std::max(1.0, end_ms())) + 1, 0.0);
    for (std::uint32_t i = 0; i < size(population); ++i) {
      for (const double t_ms : of(population, i)) {
        counts[std::min(static_cast<std::size_t>(std::max(0.0, t_ms)), counts.size() - 1)] += 1;
      }
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
  const Recording& recording_;
  std::vector<std::vector<double>> times_ms_;
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
    const std::vector<double>&x = a.of(p, i), &y = b.of(q, i);
    const auto share = 1 / static_cast<double>(count);
    difference.van_rossum += share * van_rossum_distance(x, y, kVanRossumTauMs);
    difference.victor_purpura += share * victor_purpura_distance(x, y, kVictorPurpuraPerMs);
    difference.spike += share * spike_distance(x, y, 0, end_ms);
  }
}

bool is_same_population(const Trains& a, std::size_t p, const Trains& b, std::size_t q) {
  if (a.size(p) != b.size(q)) {
    return false;
  }
  for (std::uint32_t i = 0; i < a.size(p); ++i) {
    if (a.of(p, i) != b.of(q, i)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::vector<PopulationDifference> compare_spikes(const std::vector<RecordingPair>& pairs,
                                                 const std::vector<std::uint32_t>& population_of_b) {
  std::vector<PopulationDifference> found;
  std::vector<Trains> a, b;
  for (const RecordingPair& pair : pairs) {
    a.emplace_back(pair.a);
    b.emplace_back(pair.b);
  }
  for (std::size_t q = 0; q < population_of_b.size(); ++q) {
    const std::uint32_t p = population_of_b[q];
    if (p == kNoMatch) {
      continue;
    }
    bool is_same = true;
    for (std::size_t s = 0; s < pairs.size(); ++s) {
      is_same = is_same && is_same_population(a[s], p, b[s], q);
    }
    if (is_same) {
      continue;
    }
    PopulationDifference difference;
    difference.name = pairs.front().b.populations[q].name;
    difference.rate = {"rate", "Hz", {}, {}};
    difference.latency = {"latency", "ms", {}, {}};
    for (std::size_t s = 0; s < pairs.size(); ++s) {
      difference.rate.a.push_back(a[s].rate_hz(p));
      difference.rate.b.push_back(b[s].rate_hz(q));
      const std::vector<double> profile_a = a[s].profile(p), profile_b = b[s].profile(q);
      latencies(profile_a, profile_b, std::max(a[s].size(p), b[s].size(q)), pairs[s].parts, difference.latency);
      if (s == 0) {
        difference.lag_ms = lag_ms(profile_a, profile_b);
      }
    }
    distances(a[0], p, b[0], q, difference);
    found.push_back(std::move(difference));
  }
  return found;
}

}  // namespace tectum
