// One kind of movement each, as eyes are measured: saccades by size and direction, pursuit, vergence in depth, gaze
// with the neck free, fixation of a still dot.
#pragma once

#include <functional>

#include "tools/analysis/simulated_run.h"
#include "tools/evaluate/measure_table.h"
#include "tools/evaluate/protocol.h"

namespace tectum {

/// For a protocol of kind Saccades, Pursuit, Vergence, Gaze or Fixation. Deterministic in image and protocol, whatever
/// the number of threads (0: one for each core).
[[nodiscard]] MeasuredProtocol measure_movements(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                 const std::function<void(double)>& progress);

// The five, for measure_movements.
[[nodiscard]] MeasuredProtocol measure_saccades(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                const std::function<void(double)>& progress);
[[nodiscard]] MeasuredProtocol measure_pursuit(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                               const std::function<void(double)>& progress);
[[nodiscard]] MeasuredProtocol measure_vergence(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                const std::function<void(double)>& progress);
[[nodiscard]] MeasuredProtocol measure_gaze_shifts(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                   const std::function<void(double)>& progress);
[[nodiscard]] MeasuredProtocol measure_fixation(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                const std::function<void(double)>& progress);

}  // namespace tectum
