// From a run to a line of the table, for runs that another program made too.
#pragma once

#include "runtime/record/recording.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {

/// Measures one run.
[[nodiscard]] TrialResult trial_result(const Recording& recording);
/// Fills in the rest of a result whose trials are there.
void summarize(ControllerResult& result);

}  // namespace tectum
