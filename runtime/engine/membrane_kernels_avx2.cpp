// Compiled with the AVX2 instructions (CMakeLists.txt).
#include "runtime/engine/membrane_kernels.h"

#if defined(__AVX2__)
#include <immintrin.h>

namespace tectum {
namespace {

struct Vec {
  static constexpr std::uint32_t kWidth = 8;
  using F = __m256;
  using M = __m256;  // all bits of a lane set, or none

  static F load(const float* p) noexcept { return _mm256_loadu_ps(p); }
  static void store(float* p, F x) noexcept { _mm256_storeu_ps(p, x); }
  static F set1(float x) noexcept { return _mm256_set1_ps(x); }
  static F add(F a, F b) noexcept { return _mm256_add_ps(a, b); }
  static F mul(F a, F b) noexcept { return _mm256_mul_ps(a, b); }
  static F max(F a, F b) noexcept { return _mm256_max_ps(a, b); }
  static M reaches(F a, F b) noexcept { return _mm256_cmp_ps(a, b, _CMP_GE_OQ); }
  static M below(F a, F b) noexcept { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
  static F blend(M m, F a, F b) noexcept { return _mm256_blendv_ps(a, b, m); }
  static M mask(std::uint64_t bits) noexcept {
    const __m256i lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i all = _mm256_set1_epi32(static_cast<int>(bits));
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(all, lane), lane));
  }
  static std::uint64_t bits(M m) noexcept { return static_cast<std::uint32_t>(_mm256_movemask_ps(m)); }
  static M both(M a, M b) noexcept { return _mm256_and_ps(a, b); }
  static M either(M a, M b) noexcept { return _mm256_or_ps(a, b); }
  static M without(M a, M b) noexcept { return _mm256_andnot_ps(b, a); }
  static F without_dust(F x) noexcept {
    const __m256i exponent = _mm256_and_si256(_mm256_castps_si256(x), _mm256_set1_epi32(0x60000000));
    const __m256i is_small = _mm256_cmpeq_epi32(exponent, _mm256_setzero_si256());
    return _mm256_andnot_ps(_mm256_castsi256_ps(is_small), x);
  }
  static F take_inputs(std::int32_t* p, std::uint32_t count) noexcept {
    if (count == kWidth) {
      auto* const place = reinterpret_cast<__m256i*>(p);
      const __m256i quanta = _mm256_loadu_si256(place);
      _mm256_storeu_si256(place, _mm256_setzero_si256());
      return _mm256_cvtepi32_ps(quanta);
    }
    const __m256i some = _mm256_castps_si256(mask((1U << count) - 1U));
    const __m256i quanta = _mm256_maskload_epi32(p, some);
    _mm256_maskstore_epi32(p, some, _mm256_setzero_si256());
    return _mm256_cvtepi32_ps(quanta);
  }
  static M nonzero(__m128i ticks) noexcept {
    const __m256i wide = _mm256_cvtepu16_epi32(ticks);
    return _mm256_castsi256_ps(_mm256_cmpgt_epi32(wide, _mm256_setzero_si256()));
  }
  static M was_refractory(std::uint16_t* p) noexcept {
    auto* const place = reinterpret_cast<__m128i*>(p);
    const __m128i ticks = _mm_loadu_si128(place);
    _mm_storeu_si128(place, _mm_subs_epu16(ticks, _mm_set1_epi16(1)));
    return nonzero(ticks);
  }
  static M is_refractory(const std::uint16_t* p) noexcept {
    return nonzero(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
  }
};

#include "runtime/engine/membrane_kernels_impl.h"

}  // namespace

MembraneKernels avx2_membrane_kernels(ModelKind model, std::uint32_t current_count, bool own) {
  return choose_kernels(model, current_count, own);
}

}  // namespace tectum
#endif
