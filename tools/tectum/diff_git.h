// Circuits against what they were: tectum diff --git, and as git's diff driver.
#pragma once

#include <string>
#include <vector>

#include "tools/tectum/diff_pair.h"

namespace tectum {

/// Compares arguments.a, or every circuit file under this folder that has changed, with what it was at
/// arguments.revisions. Returns the exit status, the worst of all files.
[[nodiscard]] int diff_revisions(const DiffArguments& arguments, const BatteryPlan& plan, CommandContext& context);

/// Called by git with the seven to nine arguments of an external diff driver. 0 also when the two differ: git takes
/// anything else for a crash. What is no circuit is shown line by line, as git would.
[[nodiscard]] int diff_for_git(DiffArguments arguments, const std::vector<std::string>& from_git,
                               CommandContext& context);

}  // namespace tectum
