// An evaluation as a terminal table and as JSON.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/evaluate/recorded_head.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {

/// "hold 1 s, 3 frames of camera latency".
[[nodiscard]] std::string setting_text(const Setting& setting);
[[nodiscard]] std::string gains_text(const PidGains& gains);

/// One circuit of a comparison.
struct CircuitEvaluation {
  std::string circuit;
  TrackingEvaluation evaluation;
};

/// One table for all circuits; the oracle and the PID servo are those of the first one, whose joints they have. Ends in
/// a newline. `recorded` adds what the real head did; null for none.
[[nodiscard]] std::string tracking_text(const Protocol& protocol, std::span<const CircuitEvaluation> circuits,
                                        const RecordedHead* recorded = nullptr);
/// Stable keys; angles in degrees, times in seconds. Does not end in a newline.
[[nodiscard]] std::string tracking_json(const Protocol& protocol, const std::string& circuit,
                                        const TrackingEvaluation& evaluation, const RecordedHead* recorded = nullptr);

[[nodiscard]] std::string tuning_text(const Protocol& protocol, const std::vector<PidTuningResult>& results);

}  // namespace tectum
