// The report of one run: a self-contained page, and a summary picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/record/recording.h"

namespace tectum {

struct RunReportOptions {
  std::string command_line;               // printed so that the run can be repeated; may be empty
  std::optional<double> times_real_time;  // simulation speed
  std::optional<double> zoom_begin_s;     // by default a lively part near the middle
  double zoom_length_s = 5;
  std::vector<std::string> notes;  // printed under the headline, one a line
};

/// A whole HTML file that needs nothing else. Runs without truth (video) show what the eyes saw instead of errors.
[[nodiscard]] std::string run_report_html(const Recording&, const RunReportOptions& options = {});

/// One figure for a README or a slide: target and eyes over time, the path on the wall, a spike raster.
[[nodiscard]] std::string tracking_svg(const Recording&);

}  // namespace tectum
