#include "tools/diff/spike_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tectum {
namespace {

/// Sum over all pairs of exp(-|a_i - b_j| / tau), in one walk over both trains.
double overlap(std::span<const double> a_ms, std::span<const double> b_ms, double tau_ms) {
  double sum = 0, trace_a = 0, trace_b = 0, last_ms = 0;
  for (std::size_t i = 0, j = 0; i < a_ms.size() || j < b_ms.size();) {
    const bool takes_a = j == b_ms.size() || (i < a_ms.size() && a_ms[i] <= b_ms[j]);
    const double now_ms = takes_a ? a_ms[i] : b_ms[j];
    const double decay = std::exp(-(now_ms - last_ms) / tau_ms);
    trace_a *= decay;
    trace_b *= decay;
    last_ms = now_ms;
    sum += takes_a ? trace_b : trace_a;
    (takes_a ? trace_a : trace_b) += 1;
    ++(takes_a ? i : j);
  }
  return sum;
}

/// A train between two assumed spikes, and the distance of each spike to the other train's nearest.
struct Train {
  std::vector<double> times_ms, nearest_ms;
};

/// The assumed spikes lie at the ends, or one interval beyond the outermost spike where that is farther out. A train
/// without spikes has one at each end.
Train train_of(std::span<const double> spikes_ms, double begin_ms, double end_ms) {
  std::vector<double> own(spikes_ms.begin(), spikes_ms.end());
  if (own.empty()) {
    own = {begin_ms, end_ms};
  }
  const std::size_t n = own.size();
  const double before_ms = n > 1 ? std::min(begin_ms, own[0] - (own[1] - own[0])) : begin_ms;
  const double after_ms = n > 1 ? std::max(end_ms, own[n - 1] + (own[n - 1] - own[n - 2])) : end_ms;
  Train train;
  train.times_ms.push_back(before_ms);
  train.times_ms.insert(train.times_ms.end(), own.begin(), own.end());
  train.times_ms.push_back(after_ms);
  return train;
}

/// An assumed spike is as far from the other train as the outermost spike: nothing is known beyond that.
void find_nearest(Train& train, const Train& other) {
  for (const double t : train.times_ms) {
    const auto after = std::lower_bound(other.times_ms.begin(), other.times_ms.end(), t);
    double nearest = after == other.times_ms.end() ? INFINITY : *after - t;
    if (after != other.times_ms.begin()) {
      nearest = std::min(nearest, t - *std::prev(after));
    }
    train.nearest_ms.push_back(nearest);
  }
  train.nearest_ms.front() = train.nearest_ms[1];
  train.nearest_ms.back() = train.nearest_ms[train.nearest_ms.size() - 2];
}

/// Weighted local difference S_n(t) of one train within its interval k, and the interval.
struct Local {
  double difference_ms = 0, interval_ms = 0;
};
Local local_at(const Train& train, std::size_t k, double t_ms) {
  const double interval = train.times_ms[k + 1] - train.times_ms[k];
  const double to_next = train.times_ms[k + 1] - t_ms, from_last = t_ms - train.times_ms[k];
  return {(train.nearest_ms[k] * to_next + train.nearest_ms[k + 1] * from_last) / interval, interval};
}

double profile(const Local& a, const Local& b) {
  const double mean = (a.interval_ms + b.interval_ms) / 2;
  return (a.difference_ms * b.interval_ms + b.difference_ms * a.interval_ms) / (2 * mean * mean);
}

}  // namespace

double van_rossum_distance(std::span<const double> a_ms, std::span<const double> b_ms, double tau_ms) {
  const auto self = [&](std::span<const double> train) {
    // Each pair of different spikes twice, each spike with itself once.
    double sum = 0, trace = 0;
    for (std::size_t k = 0; k < train.size(); ++k) {
      trace = k == 0 ? 0 : (trace + 1) * std::exp(-(train[k] - train[k - 1]) / tau_ms);
      sum += 2 * trace + 1;
    }
    return sum;
  };
  const double squared = (self(a_ms) + self(b_ms) - 2 * overlap(a_ms, b_ms, tau_ms)) / 2;
  return std::sqrt(std::max(0.0, squared));
}

double victor_purpura_distance(std::span<const double> a_ms, std::span<const double> b_ms, double cost_per_ms) {
  // Everything taken out and put in costs |a| + |b|; each spike moved instead saves 2 - cost |a_i - b_j|, so that only
  // spikes within 2 / cost of each other can be a pair. `saved[j]`: the most that the spikes of `a` so far and the
  // first j of `b` can save, paired in order; the same for all j from `reached` on.
  const double reach_ms = 2 / cost_per_ms;
  std::vector<double> saved(b_ms.size() + 1, 0.0);
  std::size_t first = 0, reached = 0;
  for (const double t_ms : a_ms) {
    while (first < b_ms.size() && b_ms[first] < t_ms - reach_ms) {
      ++first;
    }
    const double so_far = saved[reached];
    while (reached < first || (reached < b_ms.size() && b_ms[reached] <= t_ms + reach_ms)) {
      saved[++reached] = so_far;
    }
    double diagonal = saved[first];
    for (std::size_t j = first; j < reached; ++j) {
      const double above = saved[j + 1];
      saved[j + 1] = std::max({above, saved[j], diagonal + 2 - cost_per_ms * std::abs(t_ms - b_ms[j])});
      diagonal = above;
    }
  }
  return static_cast<double>(a_ms.size() + b_ms.size()) - saved[reached];
}

double spike_distance(std::span<const double> a_ms, std::span<const double> b_ms, double begin_ms, double end_ms) {
  Train a = train_of(a_ms, begin_ms, end_ms), b = train_of(b_ms, begin_ms, end_ms);
  find_nearest(a, b);
  find_nearest(b, a);
  std::size_t i = a.times_ms[1] <= begin_ms ? 1 : 0, j = b.times_ms[1] <= begin_ms ? 1 : 0;
  double area = 0, now_ms = begin_ms;
  while (now_ms < end_ms) {
    const double next_ms = std::min({a.times_ms[i + 1], b.times_ms[j + 1], end_ms});
    // Between neighbouring spikes of either train the profile is a straight line.
    const double first = profile(local_at(a, i, now_ms), local_at(b, j, now_ms));
    const double last = profile(local_at(a, i, next_ms), local_at(b, j, next_ms));
    area += (first + last) / 2 * (next_ms - now_ms);
    i += a.times_ms[i + 1] == next_ms ? 1U : 0U;
    j += b.times_ms[j + 1] == next_ms ? 1U : 0U;
    now_ms = next_ms;
  }
  return area / (end_ms - begin_ms);
}

}  // namespace tectum
