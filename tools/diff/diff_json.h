#pragma once

#include <string>

#include "tools/diff/behaviour.h"
#include "tools/diff/structure_diff.h"

namespace tectum {

/// Stable keys. `behaviour` may be null, when it was not looked at. Does not end in a newline.
///   {"first", "second", "same", "changes": [{kind, element, name, where, property, before, after, detail, group,
///   place,
///    because}],
///    "behaviour": {"same", "closed_loop", "what",
///      "divergence": [{kind, what, population, time_ms, how, others, why, from, changes: [index into changes]}],
///      "kinematics": [{name, unit, first, second, change, spread, beyond_spread, by_seed: [[a, b]]}],
///      "populations": [{name, first_hz, second_hz, change_hz, spread_hz, beyond_spread, lag_ms, van_rossum,
///       victor_purpura, spike}]}}
[[nodiscard]] std::string diff_json(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                                    const Behaviour* behaviour);

}  // namespace tectum
