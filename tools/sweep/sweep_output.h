// A sweep as CSV, as JSON, in words, as a page with heat maps, and as a list of commands for a cluster.
#pragma once

#include <string>
#include <vector>

#include "tools/sweep/sweep.h"

namespace tectum {

/// A column for each axis and each measure, a row for each point.
[[nodiscard]] std::string sweep_csv(const SweepPlan& plan, const SweepResult& result);
[[nodiscard]] std::string sweep_json(const SweepPlan& plan, const SweepResult& result);

/// Of a main measure, mean over the seeds: "4.28 at error_gain = 0.4 nA/deg", or "150 everywhere" and nothing.
struct MeasureExtremes {
  std::string title, least, most;
};
[[nodiscard]] std::vector<MeasureExtremes> extremes_of(const SweepPlan& plan, const SweepResult& result);

/// The same as lines.
[[nodiscard]] std::string sweep_text(const SweepPlan& plan, const SweepResult& result);

/// A heat map for each main measure over the first two axes that have more than one value, seeds last; means over the
/// others. Where the seeds are drawn, a last row has their mean.
[[nodiscard]] std::string sweep_page(const SweepPlan& plan, const SweepResult& result, const std::string& command);

/// For each point one command that runs it alone. `shared` are the words that all have in common, program first.
[[nodiscard]] std::vector<std::string> task_commands(const SweepPlan& plan, const std::string& shared);

/// The same as a script for `sbatch`.
[[nodiscard]] std::string slurm_script(const std::vector<std::string>& tasks);

/// As a POSIX shell reads it back as one word.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace tectum
