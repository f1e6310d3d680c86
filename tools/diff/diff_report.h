// A comparison as one self-contained page: what was changed, where the two part, and what the eyes and the populations
// then do.
#pragma once

#include <string>

#include "tools/diff/behaviour.h"
#include "tools/diff/subject.h"

namespace tectum {

struct DiffReportOptions {
  std::string command_line;
};

/// `behaviour` may be null: nothing was run.
[[nodiscard]] std::string diff_report_html(const DiffSubject& a, const DiffSubject& b, const StructureDiff& structure,
                                           const Behaviour* behaviour, const DiffReportOptions& options);

}  // namespace tectum
