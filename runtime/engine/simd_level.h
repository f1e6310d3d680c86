// Which instruction set the kernels may use.
#pragma once

#include "runtime/engine/spike_engine.h"

namespace tectum {

/// The best set that this processor has, no better than `wanted`; Automatic asks for the best.
[[nodiscard]] SimdLevel usable_simd_level(SimdLevel wanted);

}  // namespace tectum
