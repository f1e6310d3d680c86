// Everything that the reports say about one run, computed once.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "runtime/record/recording.h"
#include "tools/analysis/population_rates.h"
#include "tools/analysis/saccades.h"
#include "tools/analysis/tracking_metrics.h"

namespace tectum {

/// Saccades of one eye at the recording's frame rate.
struct EyeSaccades {
  std::vector<Saccade> saccades;
  std::vector<double> latencies_s;  // from a target jump to the first saccade after it
  double median_amplitude_deg = 0;
  double median_peak_velocity_deg_s = 0;
  double median_duration_s = 0;
  double median_latency_s = 0;
};

struct RunSummary {
  TrackingMetrics tracking;
  std::array<EyeSaccades, kEyeCount> saccades{};
  std::vector<PopulationSummary> populations;  // in recording order
  std::size_t spikes = 0;
  std::size_t neurons = 0;
  double mean_rate_hz = 0;  // of all neurons
  double duration_s = 0;    // first frame to one period past the last
};

[[nodiscard]] RunSummary summarize_run(const Recording&);

}  // namespace tectum
