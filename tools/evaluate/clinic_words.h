// Words that the clinic's table, JSON and page share.
#pragma once

#include <string>

#include "tools/evaluate/clinic.h"

namespace tectum {

struct ClinicTally {
  std::size_t shown = 0;
  std::size_t tried = 0;
  std::size_t of_whole = 0;  // signs that the whole circuit shows as well
};
[[nodiscard]] ClinicTally tally_of(const ClinicReport& report);

/// "shows", "MISSES", "not present".
[[nodiscard]] std::string verdict_text(ClinicVerdict verdict);
/// "8 of 9 lesions show their sign; the whole circuit shows none of the signs".
[[nodiscard]] std::string tally_text(const ClinicReport& report);
/// "left_eye.reach.left 0.8° (whole 10.1°, asked: under 4.0°)".
[[nodiscard]] std::string observation_text(const Observation& seen);
/// "Zee and others 1987, Abduction nystagmus, doi:10.1002/...".
[[nodiscard]] std::string source_text(const ClinicLesion& lesion);
/// "EBN.left, IBN.left", or "SCm_outer.left, half of it".
[[nodiscard]] std::string removed_text(const ClinicLesion& lesion, const ClinicResult& result);

}  // namespace tectum
