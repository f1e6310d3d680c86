#include "tools/analysis/run_recorder.h"

#include <utility>

#include "runtime/record/recording_file.h"

namespace tectum {

RunRecorder::RunRecorder(const SpikeImage& image) : recording_(describe_run(image)) {}

void RunRecorder::take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept {
  for (const NeuronId neuron : spikes) {
    recording_.spikes.push_back({.tick = tick, .neuron = static_cast<std::uint32_t>(neuron)});
  }
}

void RunRecorder::add_frame(RecordedFrame frame) { recording_.frames.push_back(std::move(frame)); }

}  // namespace tectum
