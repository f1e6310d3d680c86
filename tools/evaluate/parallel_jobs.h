// Independent jobs side by side on the cores. What they compute cannot depend on how many run at once, as each
// writes only to its own place.
#pragma once

#include <functional>
#include <vector>

namespace tectum {

using Job = std::function<void(const std::function<void(double)>& progress)>;

/// Runs them all. `watch` is called on this thread about ten times a second with the share that is done, weighted by
/// nothing: every job counts the same. threads = 0: one for each core.
void run_jobs(const std::vector<Job>& jobs, unsigned threads, const std::function<void(double)>& watch);

}  // namespace tectum
