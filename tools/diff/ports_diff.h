// What differs where a circuit meets the world: retinas, outputs, joints.
#pragma once

#include <vector>

#include "tools/diff/structure_diff.h"

namespace tectum {

[[nodiscard]] std::vector<Change> diff_ports(const CircuitView& a, const CircuitView& b, const Correspondence& match);

}  // namespace tectum
