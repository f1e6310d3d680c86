#include "runtime/engine/simd_level.h"

namespace tectum {

SimdLevel usable_simd_level(SimdLevel wanted) {
#if defined(__x86_64__)
  const bool has_avx2 = __builtin_cpu_supports("avx2");
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  const bool is_automatic = wanted == SimdLevel::Automatic;
  if (has_avx512 && (is_automatic || wanted == SimdLevel::Avx512)) {
    return SimdLevel::Avx512;
  }
  if (has_avx2 && (is_automatic || wanted == SimdLevel::Avx512 || wanted == SimdLevel::Avx2)) {
    return SimdLevel::Avx2;
  }
#else
  (void)wanted;
#endif
  return SimdLevel::Portable;
}

}  // namespace tectum
