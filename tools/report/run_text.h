// The numbers of a run as a terminal table and as JSON.
#pragma once

#include <string>

#include "runtime/record/recording.h"
#include "tools/analysis/run_summary.h"

namespace tectum {

/// Aligned columns, one row for each eye and axis, then saccades, spikes and the neck. Ends in a newline.
[[nodiscard]] std::string run_table_text(const RunSummary&);

/// Stable keys; angles in degrees, times in seconds, rates in hertz. Does not end in a newline.
[[nodiscard]] std::string run_summary_json(const Recording&, const RunSummary&);

}  // namespace tectum
