// One run of a circuit on a path of the dot, as traces fine enough for saccades.
//
// Kept apart are what the motoneurons' decoder asks of each eye over its window (`command`), what the same spikes would
// do to a human eye (`eye`, tools/evaluate/eye_plant.h) and where the servos' shafts are (`plant`): an AX-12A turns at
// 354 deg/s at most, so that only the first two can follow the main sequence.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/saccades.h"
#include "tools/analysis/simulated_run.h"
#include "tools/evaluate/eye_plant.h"
#include "tools/evaluate/protocol.h"

namespace tectum {

inline constexpr double kMovementSampleS = kEyeSampleS;

struct Pause {
  double begin_s = 0, end_s = 0;
};

struct MovementTrial {
  std::array<AngleTrace, kEyeCount> command;  // eye in head, every kMovementSampleS
  std::array<AngleTrace, kEyeCount> eye;      // the human eye in its head, every kMovementSampleS
  std::array<AngleTrace, kEyeCount> plant;    // the eyes' shafts, eye in head, every kMovementSampleS
  std::vector<Pause> opn_pauses;              // of the omnipause neurons: the neural mark of every saccade
  Recording recording;                        // frames with truth; no spikes
};

/// `path` in the options' scenario; the other options as tools/evaluate/tracking_evaluation.h makes them.
[[nodiscard]] MovementTrial run_movement(const SpikeImage& image, const SimulatedRunOptions& options,
                                         const std::function<void(double)>& progress);

/// Pan and tilt as seen from the head's origin, on the plane at `distance_m`.
[[nodiscard]] std::array<double, 2> place_m(double pan_deg, double tilt_deg, double distance_m);

/// Mean over the samples in [from_s, to_s); 0 where there is none.
[[nodiscard]] double mean_between(const AngleTrace& trace, const std::vector<double>& values, double from_s,
                                  double to_s);

/// The saccades of a trace whose noise stays below `threshold_deg_s`.
[[nodiscard]] std::vector<Saccade> saccades_of(const AngleTrace& trace, double threshold_deg_s);

}  // namespace tectum
