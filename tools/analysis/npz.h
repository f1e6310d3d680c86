// Recordings as NumPy arrays.
#pragma once

#include <string>

#include "runtime/record/recording.h"

namespace tectum {

/// One uncompressed .npz: time_s, tick, decoded_deg, goal_deg, position_deg (turns x 6 joints), guard_state, late_s,
/// stage_s, captured_s, spike_tick, spike_neuron, population_first_neuron and _size, the active fields of each eye as
/// (turn, field) pairs, and with truth error_deg (turns x 2 eyes x pan, tilt) and target_m. One line when it cannot be
/// written, else empty. The same recording gives the same bytes.
[[nodiscard]] std::string write_recording_npz(const Recording& recording, const std::string& path);

}  // namespace tectum
