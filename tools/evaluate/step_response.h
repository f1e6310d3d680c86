// What an eye does after each jump of the target: when it starts, how far it goes too far, when it has arrived.
#pragma once

#include <vector>

#include "tools/analysis/gaze_traces.h"

namespace tectum {

struct StepResponse {
  double at_s = 0;
  double size_deg = 0;
  double latency_s = 0;        // until a tenth of the way is done; the hold's length when it never is
  double overshoot_share = 0;  // farthest point beyond the target along the jump, over the jump; 0 when short
  double settled_s = 0;        // from then on within settled_within_deg until the next jump; the hold's length if never
  bool has_settled = false;
};

struct StepOptions {
  double settled_within_deg = 2;
  double smallest_deg = 2;  // jumps below this say nothing about overshoot
};

struct StepSummary {
  std::size_t steps = 0;
  std::size_t settled = 0;
  double median_latency_s = 0;
  double median_overshoot_share = 0;
  double p90_overshoot_share = 0;
  double median_settled_s = 0;
  double p90_settled_s = 0;
};

/// Gaze and target sampled at the same times, as pan and tilt in one frame. The first hold, into which the head starts,
/// is left out.
[[nodiscard]] std::vector<StepResponse> step_responses(const AngleTrace& gaze, const AngleTrace& target,
                                                       const std::vector<double>& jumps_s,
                                                       const StepOptions& options = {});
[[nodiscard]] StepSummary summarize_steps(const std::vector<StepResponse>& responses);

}  // namespace tectum
