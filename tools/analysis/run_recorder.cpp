#include "tools/analysis/run_recorder.h"

#include <algorithm>
#include <utility>

#include "runtime/record/recording_file.h"

namespace tectum {

RunRecorder::RunRecorder(const SpikeImage& image) : recording_(describe_run(image)) {}

void RunRecorder::expect(double duration_s) {
  constexpr double kRateHz = 50;                     // of a busy circuit's neuron, on average
  constexpr double kMostBytes = 64.0 * 1024 * 1024;  // pages are taken only when written
  std::size_t neurons = 0;
  for (const RecordedPopulation& population : recording_.populations) {
    neurons += population.size;
  }
  const double spikes = kRateHz * duration_s * static_cast<double>(neurons);
  recording_.spikes.reserve(static_cast<std::size_t>(std::min(spikes, kMostBytes / sizeof(RecordedSpike))));
}

void RunRecorder::take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept {
  for (const NeuronId neuron : spikes) {
    recording_.spikes.push_back({.tick = tick, .neuron = static_cast<std::uint32_t>(neuron)});
  }
}

void RunRecorder::add_frame(RecordedFrame frame) { recording_.frames.push_back(std::move(frame)); }

}  // namespace tectum
