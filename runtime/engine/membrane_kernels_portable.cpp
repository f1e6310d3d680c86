// Plain C++, for any processor.
#include "runtime/engine/membrane_kernels.h"

#define TECTUM_EACH_LANE for (std::uint32_t k = 0; k < kWidth; ++k)

namespace tectum {
namespace {

struct Vec {
  static constexpr std::uint32_t kWidth = 4;
  struct F {
    float lane[kWidth];
  };
  struct M {
    bool lane[kWidth];
  };

  template <typename Lanes, typename Function>
  [[gnu::always_inline]] static Lanes each(Function f) noexcept {
    Lanes x;
    TECTUM_EACH_LANE x.lane[k] = f(k);
    return x;
  }

  static F load(const float* p) noexcept {
    return each<F>([=](std::uint32_t k) { return p[k]; });
  }
  static void store(float* p, F x) noexcept { TECTUM_EACH_LANE p[k] = x.lane[k]; }
  static F set1(float x) noexcept {
    return each<F>([=](std::uint32_t) { return x; });
  }
  static F add(F a, F b) noexcept {
    return each<F>([&](std::uint32_t k) { return a.lane[k] + b.lane[k]; });
  }
  static F mul(F a, F b) noexcept {
    return each<F>([&](std::uint32_t k) { return a.lane[k] * b.lane[k]; });
  }
  static F max(F a, F b) noexcept {
    return each<F>([&](std::uint32_t k) { return a.lane[k] > b.lane[k] ? a.lane[k] : b.lane[k]; });
  }
  static M reaches(F a, F b) noexcept {
    return each<M>([&](std::uint32_t k) { return a.lane[k] >= b.lane[k]; });
  }
  static M below(F a, F b) noexcept {
    return each<M>([&](std::uint32_t k) { return a.lane[k] < b.lane[k]; });
  }
  static F blend(M m, F a, F b) noexcept {
    return each<F>([&](std::uint32_t k) { return m.lane[k] ? b.lane[k] : a.lane[k]; });
  }
  static M mask(std::uint64_t bits) noexcept {
    return each<M>([=](std::uint32_t k) { return ((bits >> k) & 1U) != 0; });
  }
  static std::uint64_t bits(M m) noexcept {
    std::uint64_t result = 0;
    TECTUM_EACH_LANE result |= static_cast<std::uint64_t>(m.lane[k]) << k;
    return result;
  }
  static M both(M a, M b) noexcept {
    return each<M>([&](std::uint32_t k) { return a.lane[k] && b.lane[k]; });
  }
  static M either(M a, M b) noexcept {
    return each<M>([&](std::uint32_t k) { return a.lane[k] || b.lane[k]; });
  }
  static M without(M a, M b) noexcept {
    return each<M>([&](std::uint32_t k) { return a.lane[k] && !b.lane[k]; });
  }
  static F without_dust(F x) noexcept {
    constexpr float kDust = 0x1p-63F;
    return each<F>([&](std::uint32_t k) { return x.lane[k] < kDust && x.lane[k] > -kDust ? 0.0F : x.lane[k]; });
  }
  static F take_all_inputs(std::int32_t* p) noexcept {
    const F quanta = each<F>([=](std::uint32_t k) { return static_cast<float>(p[k]); });
    TECTUM_EACH_LANE p[k] = 0;
    return quanta;
  }
  static F take_inputs(std::int32_t* p, std::uint64_t lanes) noexcept {
    return each<F>([=](std::uint32_t k) {
      const bool is_on = ((lanes >> k) & 1U) != 0;
      const std::int32_t quanta = is_on ? p[k] : 0;
      if (is_on) {
        p[k] = 0;
      }
      return static_cast<float>(quanta);
    });
  }
  static M was_refractory(std::uint16_t* p) noexcept {
    const M was = is_refractory(p);
    TECTUM_EACH_LANE p[k] = static_cast<std::uint16_t>(p[k] - (was.lane[k] ? 1 : 0));
    return was;
  }
  static M is_refractory(const std::uint16_t* p) noexcept {
    return each<M>([=](std::uint32_t k) { return p[k] != 0; });
  }

  struct I {
    std::uint32_t lane[kWidth];
  };
  static I indices(const std::uint32_t* p, std::uint64_t lanes) noexcept {
    return each<I>([=](std::uint32_t k) { return ((lanes >> k) & 1U) != 0 ? p[k] : 0U; });
  }
  static I set1i(std::uint32_t x) noexcept {
    return each<I>([=](std::uint32_t) { return x; });
  }
  static I sub(I a, I b) noexcept {
    return each<I>([&](std::uint32_t k) { return a.lane[k] - b.lane[k]; });
  }
  static I bits_of(I a, std::uint32_t x) noexcept {
    return each<I>([&](std::uint32_t k) { return a.lane[k] & x; });
  }
  static I times(I a, std::uint32_t x) noexcept {
    return each<I>([&](std::uint32_t k) { return a.lane[k] * x; });
  }
  static I shift_right(I a, std::uint32_t bits) noexcept {
    return each<I>([&](std::uint32_t k) { return a.lane[k] >> bits; });
  }
  static M nonzero(I a) noexcept {
    return each<M>([&](std::uint32_t k) { return a.lane[k] != 0; });
  }
  static F gather(const float* base, I index, M on) noexcept {
    return each<F>([&](std::uint32_t k) { return on.lane[k] ? base[index.lane[k]] : 0.0F; });
  }
  static I gather_integers(const std::uint32_t* base, I index, M on) noexcept {
    return each<I>([&](std::uint32_t k) { return on.lane[k] ? base[index.lane[k]] : 0U; });
  }
  static M gather_refractory(const std::uint16_t* base, I index, M on) noexcept {
    return each<M>([&](std::uint32_t k) { return on.lane[k] && base[index.lane[k]] != 0; });
  }
  static void scatter(float* base, I index, M on, F x) noexcept {
    TECTUM_EACH_LANE if (on.lane[k]) { base[index.lane[k]] = x.lane[k]; }
  }
  static void scatter_integers(std::uint32_t* base, I index, M on, I x) noexcept {
    TECTUM_EACH_LANE if (on.lane[k]) { base[index.lane[k]] = x.lane[k]; }
  }
  static F take_gathered_inputs(std::int32_t* base, I index, M on) noexcept {
    return each<F>([&](std::uint32_t k) {
      const std::int32_t quanta = on.lane[k] ? base[index.lane[k]] : 0;
      if (on.lane[k]) {
        base[index.lane[k]] = 0;
      }
      return static_cast<float>(quanta);
    });
  }
};

#include "runtime/engine/membrane_kernels_impl.h"

}  // namespace

MembraneKernels portable_membrane_kernels(ModelKind model, std::uint32_t current_count, bool own) {
  return choose_kernels(model, current_count, own);
}

}  // namespace tectum
