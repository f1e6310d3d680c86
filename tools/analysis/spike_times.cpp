#include "tools/analysis/spike_times.h"

namespace tectum {

SpikeClock::SpikeClock(const Recording& recording)
    : recording_(recording), tick_s_(static_cast<double>(recording.tick_ns) * 1e-9) {}

double SpikeClock::time_s(std::uint64_t tick) {
  const std::vector<RecordedFrame>& frames = recording_.frames;
  if (frames.empty()) {
    return static_cast<double>(tick) * tick_s_;
  }
  const bool is_later = frame_ + 1 < frames.size() && frames[frame_ + 1].tick <= tick;
  if (is_later || frames[frame_].tick > tick) {
    const auto after = std::upper_bound(frames.begin(), frames.end(), tick,
                                        [](std::uint64_t t, const RecordedFrame& frame) { return t < frame.tick; });
    frame_ = after == frames.begin() ? 0 : static_cast<std::size_t>(after - frames.begin()) - 1;
  }
  const double since_ticks = static_cast<double>(tick) - static_cast<double>(frames[frame_].tick);
  return static_cast<double>(frames[frame_].time_ns) * 1e-9 + since_ticks * tick_s_;
}

std::span<const RecordedSpike> spikes_between(const Recording& recording, double begin_s, double end_s) {
  SpikeClock clock(recording);
  // Half a nanosecond forgives the rounding of a tick's time at a boundary.
  const auto is_before = [&](const RecordedSpike& spike, double limit_s) {
    return clock.time_s(spike.tick) < limit_s - 0.5e-9;
  };
  const auto first = std::lower_bound(recording.spikes.begin(), recording.spikes.end(), begin_s, is_before);
  const auto last = std::lower_bound(first, recording.spikes.end(), end_s, is_before);
  return {first, last};
}

std::vector<std::uint32_t> population_of_neurons(const Recording& recording) {
  std::size_t neurons = 0;
  for (const RecordedPopulation& population : recording.populations) {
    neurons = std::max(neurons, std::size_t{population.first_neuron} + population.size);
  }
  std::vector<std::uint32_t> index(neurons, kNoPopulation);
  for (std::size_t p = 0; p < recording.populations.size(); ++p) {
    const RecordedPopulation& population = recording.populations[p];
    std::fill_n(index.begin() + population.first_neuron, population.size, static_cast<std::uint32_t>(p));
  }
  return index;
}

std::vector<double> spike_times_s(const Recording& recording) {
  SpikeClock clock(recording);
  std::vector<double> times_s;
  times_s.reserve(recording.spikes.size());
  for (const RecordedSpike& spike : recording.spikes) {
    times_s.push_back(clock.time_s(spike.tick));
  }
  return times_s;
}

}  // namespace tectum
