// What `tectum eval` measured, as one HTML page that needs nothing else.
#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/measure_table.h"
#include "tools/evaluate/physiology.h"
#include "tools/evaluate/protocol.h"
#include "tools/evaluate/recorded_head.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {

struct EvaluationTitle {
  std::string circuit;
  std::string command_line;  // printed so that the run can be repeated
};

[[nodiscard]] std::string tracking_report(const EvaluationTitle& title, const Protocol& protocol,
                                          const TrackingEvaluation& evaluation, const RecordedHead* recorded = nullptr);
[[nodiscard]] std::string physiology_report(const EvaluationTitle& title, const Protocol& protocol,
                                            const std::vector<Yardstick>& yardsticks);
[[nodiscard]] std::string measures_report(const EvaluationTitle& title, const Protocol& protocol,
                                          const MeasuredProtocol& measured);
/// What the terminal shows, on a page.
[[nodiscard]] std::string text_report(const EvaluationTitle& title, const Protocol& protocol, const std::string& text);

}  // namespace tectum
