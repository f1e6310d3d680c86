#include "tools/analysis/run_summary.h"

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

EyeSaccades eye_saccades(const Recording& recording, Eye eye, const std::vector<double>& jumps_s) {
  EyeSaccades result;
  result.saccades = detect_saccades(gaze_trace(recording, eye),
                                    frame_rate_saccade_options(static_cast<double>(recording.frame_period_ns) * 1e-9));
  result.latencies_s = saccade_latencies_s(result.saccades, jumps_s);
  std::vector<double> amplitudes_deg;
  std::vector<double> peaks_deg_s;
  std::vector<double> durations_s;
  for (const Saccade& saccade : result.saccades) {
    amplitudes_deg.push_back(saccade.amplitude_deg);
    peaks_deg_s.push_back(saccade.peak_velocity_deg_s);
    durations_s.push_back(saccade.duration_s);
  }
  result.median_amplitude_deg = median(amplitudes_deg);
  result.median_peak_velocity_deg_s = median(peaks_deg_s);
  result.median_duration_s = median(durations_s);
  result.median_latency_s = median(result.latencies_s);
  return result;
}

}  // namespace

RunSummary summarize_run(const Recording& recording) {
  RunSummary summary;
  summary.tracking = tracking_metrics(recording);
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    summary.saccades[static_cast<std::size_t>(eye)] = eye_saccades(recording, eye, summary.tracking.target_jumps_s);
  }
  summary.populations = population_summaries(recording);
  summary.spikes = recording.spikes.size();
  for (const RecordedPopulation& population : recording.populations) {
    summary.neurons += population.size;
  }
  const TimeRange range = time_range(recording);
  summary.duration_s = range.end_s - range.begin_s;
  if (summary.neurons > 0 && summary.duration_s > 0) {
    summary.mean_rate_hz =
        static_cast<double>(summary.spikes) / static_cast<double>(summary.neurons) / summary.duration_s;
  }
  return summary;
}

}  // namespace tectum
