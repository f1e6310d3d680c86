#include "runtime/engine/membrane_kernels.h"

#include "runtime/engine/simd_level.h"

namespace tectum {

MembraneKernels membrane_kernels(SimdLevel level, ModelKind model, std::uint32_t current_count,
                                 bool has_own_thresholds) {
  switch (usable_simd_level(level)) {
#if defined(__x86_64__)
    case SimdLevel::Avx512:
      return avx512_membrane_kernels(model, current_count, has_own_thresholds);
    case SimdLevel::Avx2:
      return avx2_membrane_kernels(model, current_count, has_own_thresholds);
#endif
    default:
      return portable_membrane_kernels(model, current_count, has_own_thresholds);
  }
}

}  // namespace tectum
