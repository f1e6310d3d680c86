// The course of an eye after a jump of the target, of several controllers in one chart.
#pragma once

#include "tools/evaluate/recorded_head.h"
#include "tools/evaluate/tracking_evaluation.h"
#include "tools/report/chart.h"

namespace tectum {

/// Share of the way to the target that is done, for each frame since the jump: the median over a run's jumps and both
/// eyes. The first hold, into which the head starts, is left out, as are ways below 2 deg.
[[nodiscard]] std::vector<double> median_course(const Recording& recording, double until_s);

[[nodiscard]] Chart step_chart(const SettingResult& setting, const RecordedHead& recorded);

}  // namespace tectum
