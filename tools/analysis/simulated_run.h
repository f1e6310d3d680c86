// A circuit in the simulated head, in virtual time.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "drivers/head/sim_head.h"
#include "runtime/image/load_image.h"
#include "runtime/loop/control_loop.h"
#include "runtime/record/recording.h"

namespace tectum {

struct SimulatedRunOptions {
  SimHeadParams head;
  double duration_s = 60;
  double sample_rate_hz = 0;  // of the shafts between the frames, into Recording::positions; 0: not sampled
  bool learns = false;        // weights change as the circuit declares
  bool keeps_spikes = true;   // off: a long run that only the eyes are wanted of
  EngineOptions engine;
};

/// The head's cameras and laser as the circuit's first retina expects them: its field of view, and a dot in the colour
/// that it calls lit. Without a retina the parameters come back as they are.
[[nodiscard]] SimHeadParams fitted_to(const SpikeImage& image, SimHeadParams head);

/// What the simulated head knows of a turn and the loop does not.
void add_truth(const HeadTruth& truth, RecordedFrame& frame);

/// Called after every frame with the share of the run that is done, and the two eyes' pictures.
struct RunObserver {
  std::function<void(double done)> progress;
  std::function<void(const Frame& left, const Frame& right)> pictures;  // only with frames in hand
  /// At the end of a run that learns: the factor of each plastic synapse, in 2^-kScaleBits.
  std::function<void(std::span<const std::int32_t> scales)> learned = {};
};

/// Runs for duration_s of virtual time. Deterministic in its arguments.
[[nodiscard]] Recording run_simulated_head(const SpikeImage& image, const SimulatedRunOptions& options,
                                           const RunObserver& observer = {});

}  // namespace tectum
