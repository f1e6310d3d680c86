// Compiled with the AVX-512 F, BW, DQ and VL instructions (CMakeLists.txt).
#include "runtime/engine/membrane_kernels.h"

#if defined(__AVX512F__)
#include <immintrin.h>

namespace tectum {
namespace {

struct Vec {
  static constexpr std::uint32_t kWidth = 16;
  using F = __m512;
  using M = __mmask16;

  static F load(const float* p) noexcept { return _mm512_loadu_ps(p); }
  static void store(float* p, F x) noexcept { _mm512_storeu_ps(p, x); }
  static F set1(float x) noexcept { return _mm512_set1_ps(x); }
  static F add(F a, F b) noexcept { return _mm512_add_ps(a, b); }
  static F mul(F a, F b) noexcept { return _mm512_mul_ps(a, b); }
  static F max(F a, F b) noexcept { return _mm512_max_ps(a, b); }
  static M reaches(F a, F b) noexcept { return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ); }
  static M below(F a, F b) noexcept { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
  static F blend(M m, F a, F b) noexcept { return _mm512_mask_blend_ps(m, a, b); }
  static M mask(std::uint64_t bits) noexcept { return static_cast<M>(bits); }
  static std::uint64_t bits(M m) noexcept { return m; }
  static M both(M a, M b) noexcept { return a & b; }
  static M either(M a, M b) noexcept { return a | b; }
  static M without(M a, M b) noexcept { return static_cast<M>(a & ~b); }
  static F without_dust(F x) noexcept {
    const M is_large = _mm512_test_epi32_mask(_mm512_castps_si512(x), _mm512_set1_epi32(0x60000000));
    return _mm512_maskz_mov_ps(is_large, x);
  }
  static F take_all_inputs(std::int32_t* p) noexcept {
    const __m512i quanta = _mm512_loadu_si512(p);
    _mm512_storeu_si512(p, _mm512_setzero_si512());
    return _mm512_cvtepi32_ps(quanta);
  }
  static F take_inputs(std::int32_t* p, std::uint64_t lanes) noexcept {
    const __m512i quanta = _mm512_maskz_loadu_epi32(mask(lanes), p);
    _mm512_mask_storeu_epi32(p, mask(lanes), _mm512_setzero_si512());
    return _mm512_cvtepi32_ps(quanta);
  }
  static M was_refractory(std::uint16_t* p) noexcept {
    auto* const place = reinterpret_cast<__m256i*>(p);
    const __m256i ticks = _mm256_loadu_si256(place);
    _mm256_storeu_si256(place, _mm256_subs_epu16(ticks, _mm256_set1_epi16(1)));
    return _mm256_test_epi16_mask(ticks, ticks);
  }
  static M is_refractory(const std::uint16_t* p) noexcept {
    const __m256i ticks = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
    return _mm256_test_epi16_mask(ticks, ticks);
  }

  using I = __m512i;
  static I indices(const std::uint32_t* p, std::uint64_t lanes) noexcept {
    return _mm512_maskz_loadu_epi32(mask(lanes), p);
  }
  static I set1i(std::uint32_t x) noexcept { return _mm512_set1_epi32(static_cast<int>(x)); }
  static I sub(I a, I b) noexcept { return _mm512_sub_epi32(a, b); }
  static I bits_of(I a, std::uint32_t x) noexcept { return _mm512_and_si512(a, set1i(x)); }
  static I times(I a, std::uint32_t x) noexcept { return _mm512_mullo_epi32(a, set1i(x)); }
  static I shift_right(I a, std::uint32_t bits) noexcept {
    return _mm512_srl_epi32(a, _mm_cvtsi32_si128(static_cast<int>(bits)));
  }
  static M nonzero(I a) noexcept { return _mm512_test_epi32_mask(a, a); }
  static F gather(const float* base, I index, M on) noexcept {
    return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), on, index, base, 4);
  }
  static I gather_integers(const std::uint32_t* base, I index, M on) noexcept {
    return _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), on, index, base, 4);
  }
  // Reads two bytes beyond the last counter.
  static M gather_refractory(const std::uint16_t* base, I index, M on) noexcept {
    const __m512i pair = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), on, index, base, 2);
    return _mm512_test_epi32_mask(pair, _mm512_set1_epi32(0xFFFF));
  }
  static void scatter(float* base, I index, M on, F x) noexcept { _mm512_mask_i32scatter_ps(base, on, index, x, 4); }
  static void scatter_integers(std::uint32_t* base, I index, M on, I x) noexcept {
    _mm512_mask_i32scatter_epi32(base, on, index, x, 4);
  }
  static F take_gathered_inputs(std::int32_t* base, I index, M on) noexcept {
    const __m512i quanta = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), on, index, base, 4);
    _mm512_mask_i32scatter_epi32(base, on, index, _mm512_setzero_si512(), 4);
    return _mm512_cvtepi32_ps(quanta);
  }
};

#include "runtime/engine/membrane_kernels_impl.h"

}  // namespace

MembraneKernels avx512_membrane_kernels(ModelKind model, std::uint32_t current_count, bool own) {
  return choose_kernels(model, current_count, own);
}

}  // namespace tectum
#endif
