// A sweep's results on disk: one file a run.
#pragma once

#include <optional>
#include <string>

#include "tools/sweep/sweep.h"

namespace tectum {

[[nodiscard]] std::string row_path(const std::string& folder, const std::string& digest);

/// Both return one line that says what went wrong, or nothing.
[[nodiscard]] std::string make_row_folder(const std::string& folder);
[[nodiscard]] std::string write_row(const std::string& folder, const std::string& digest, const SweepRow& row);

/// Nothing when there is no such row, or it does not hold what a row holds.
[[nodiscard]] std::optional<SweepRow> read_row(const std::string& folder, const std::string& digest);

/// One measure as the CSV has it; empty for what was not measured.
[[nodiscard]] std::string cell_text(const std::optional<double>& value);

}  // namespace tectum
