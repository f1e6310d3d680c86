// A video run as lines: what each eye sees and what the servos are told.
#pragma once

#include <cstddef>
#include <string>

#include "runtime/record/recording.h"

namespace tectum {

/// One line a frame, thinned out evenly to at most `max_lines` (0 = all). Angles in degrees; a field group's place is
/// the mean of its fields' centres, as an angle from the optical axis.
[[nodiscard]] std::string video_text(const Recording& recording, std::size_t max_lines);

}  // namespace tectum
