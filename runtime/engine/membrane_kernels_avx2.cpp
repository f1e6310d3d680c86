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
  static F take_all_inputs(std::int32_t* p) noexcept {
    auto* const place = reinterpret_cast<__m256i*>(p);
    const __m256i quanta = _mm256_loadu_si256(place);
    _mm256_storeu_si256(place, _mm256_setzero_si256());
    return _mm256_cvtepi32_ps(quanta);
  }
  static F take_inputs(std::int32_t* p, std::uint64_t lanes) noexcept {
    const __m256i some = _mm256_castps_si256(mask(lanes));
    const __m256i quanta = _mm256_maskload_epi32(p, some);
    _mm256_maskstore_epi32(p, some, _mm256_setzero_si256());
    return _mm256_cvtepi32_ps(quanta);
  }
  static M nonzero_ticks(__m128i ticks) noexcept {
    const __m256i wide = _mm256_cvtepu16_epi32(ticks);
    return _mm256_castsi256_ps(_mm256_cmpgt_epi32(wide, _mm256_setzero_si256()));
  }
  static M was_refractory(std::uint16_t* p) noexcept {
    auto* const place = reinterpret_cast<__m128i*>(p);
    const __m128i ticks = _mm_loadu_si128(place);
    _mm_storeu_si128(place, _mm_subs_epu16(ticks, _mm_set1_epi16(1)));
    return nonzero_ticks(ticks);
  }
  static M is_refractory(const std::uint16_t* p) noexcept {
    return nonzero_ticks(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
  }

  using I = __m256i;
  static I indices(const std::uint32_t* p, std::uint64_t lanes) noexcept {
    return _mm256_maskload_epi32(reinterpret_cast<const int*>(p), _mm256_castps_si256(mask(lanes)));
  }
  static I set1i(std::uint32_t x) noexcept { return _mm256_set1_epi32(static_cast<int>(x)); }
  static I sub(I a, I b) noexcept { return _mm256_sub_epi32(a, b); }
  static I bits_of(I a, std::uint32_t x) noexcept { return _mm256_and_si256(a, set1i(x)); }
  static I times(I a, std::uint32_t x) noexcept { return _mm256_mullo_epi32(a, set1i(x)); }
  static I shift_right(I a, std::uint32_t bits) noexcept {
    return _mm256_srl_epi32(a, _mm_cvtsi32_si128(static_cast<int>(bits)));
  }
  static M nonzero(I a) noexcept {
    const __m256i is_zero = _mm256_cmpeq_epi32(a, _mm256_setzero_si256());
    return _mm256_castsi256_ps(_mm256_xor_si256(is_zero, _mm256_set1_epi32(-1)));
  }
  static F gather(const float* base, I index, M on) noexcept {
    return _mm256_mask_i32gather_ps(_mm256_setzero_ps(), base, index, on, 4);
  }
  static I gather_integers(const std::uint32_t* base, I index, M on) noexcept {
    return _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), reinterpret_cast<const int*>(base), index,
                                       _mm256_castps_si256(on), 4);
  }
  // Reads two bytes beyond the last counter.
  static M gather_refractory(const std::uint16_t* base, I index, M on) noexcept {
    const __m256i pair = _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), reinterpret_cast<const int*>(base), index,
                                                     _mm256_castps_si256(on), 2);
    return nonzero(_mm256_and_si256(pair, _mm256_set1_epi32(0xFFFF)));
  }
  // AVX2 has no scatter.
  template <typename T>
  static void scatter_lanes(T* base, I index, M on, const T* values) noexcept {
    alignas(32) std::uint32_t place[kWidth];
    _mm256_store_si256(reinterpret_cast<__m256i*>(place), index);
    for (std::uint64_t left = bits(on); left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctzll(left));
      base[place[k]] = values[k];
    }
  }
  static void scatter(float* base, I index, M on, F x) noexcept {
    alignas(32) float values[kWidth];
    _mm256_store_ps(values, x);
    scatter_lanes(base, index, on, values);
  }
  static void scatter_integers(std::uint32_t* base, I index, M on, I x) noexcept {
    alignas(32) std::uint32_t values[kWidth];
    _mm256_store_si256(reinterpret_cast<__m256i*>(values), x);
    scatter_lanes(base, index, on, values);
  }
  static F take_gathered_inputs(std::int32_t* base, I index, M on) noexcept {
    const __m256i quanta = _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), base, index, _mm256_castps_si256(on), 4);
    const std::int32_t zeroes[kWidth] = {};
    scatter_lanes(base, index, on, zeroes);
    return _mm256_cvtepi32_ps(quanta);
  }
};

#include "runtime/engine/membrane_kernels_impl.h"

}  // namespace

MembraneKernels avx2_membrane_kernels(ModelKind model, std::uint32_t current_count, bool own) {
  return choose_kernels(model, current_count, own);
}

}  // namespace tectum
#endif
