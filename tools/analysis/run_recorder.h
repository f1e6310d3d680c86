// Collects a run in memory: the spikes as the loop's sink, the frames as the caller hands them over.
#pragma once

#include "runtime/image/load_image.h"
#include "runtime/loop/spike_sink.h"
#include "runtime/record/recording.h"

namespace tectum {

class RunRecorder final : public SpikeSink {
 public:
  /// Fills in what the image knows: name, checksum, tick, populations, retinas.
  explicit RunRecorder(const SpikeImage& image);

  /// Sets aside address space for the spikes to come, so that a growing list is not copied again and again.
  void expect(double duration_s);
  void take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept override;
  void add_frame(RecordedFrame frame);

  [[nodiscard]] Recording& recording() { return recording_; }

 private:
  Recording recording_;
};

}  // namespace tectum
