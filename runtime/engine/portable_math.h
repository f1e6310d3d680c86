// Elementary functions that give the same bits on every machine.
//
// libm's differ between machines, so the engine must not call it. These use only +, -, *, /, sqrt,
// comparisons and bit patterns, which IEEE 754 fixes, and are compiled without fused multiply-add.
// Accuracy is a few units in the last place (tests/engine/portable_math_test.cpp states the bounds).
// exp, exp_ratio and log have no branches, so that loops over them become SIMD code.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tectum::portable {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kPi = 3.14159265358979311600;
inline constexpr double kHalfPi = 1.57079632679489655800;
inline constexpr double kLn2 = 0.69314718055994528623;
// ln 2 in two parts: the first has 33 significant bits, so n * kLn2High is exact for |n| < 2^20.
inline constexpr double kLn2High = 0x1.62e42feep-1;
inline constexpr double kLn2Low = 0x1.a39ef35793c76p-33;

/// Adding and subtracting 3 * 2^51 leaves the nearest whole number, for |x| < 2^51.
inline double round_to_whole(double x) noexcept { return (x + 0x1.8p52) - 0x1.8p52; }

/// 2^n for whole n in -1022 .. 1023, from the bits.
inline double two_to(double n) noexcept {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(n + 0x1.8p52 + 1023.0) << 52U);
}

/// (e^r - 1) / r for |r| <= ln(2) / 2: the Taylor series, whose first omitted term is below 2^-57.
inline double exp_ratio_series(double r) noexcept {
  double sum = 1.0 / 87178291200.0;  // 1 / 14!
  sum = sum * r + 1.0 / 6227020800.0;
  sum = sum * r + 1.0 / 479001600.0;
  sum = sum * r + 1.0 / 39916800.0;
  sum = sum * r + 1.0 / 3628800.0;
  sum = sum * r + 1.0 / 362880.0;
  sum = sum * r + 1.0 / 40320.0;
  sum = sum * r + 1.0 / 5040.0;
  sum = sum * r + 1.0 / 720.0;
  sum = sum * r + 1.0 / 120.0;
  sum = sum * r + 1.0 / 24.0;
  sum = sum * r + 1.0 / 6.0;
  sum = sum * r + 0.5;
  return sum * r + 1.0;
}

/// x = n ln 2 + r: e^x = 2^n (1 + r s) with s the series above. 2^n is applied in two halves, so that
/// results near the ends of the range neither overflow nor lose their sign bit on the way.
struct ExpParts {
  double half_scale;   // 2^(n/2), rounded down
  double other_scale;  // the rest of 2^n
  double fraction;     // e^r - 1
};
inline ExpParts exp_parts(double x) noexcept {
  // Beyond these lie 0 and infinity. One comparison a line, each a minimum or maximum instruction; NaN stays.
  const double above = x < -760.0 ? -760.0 : x;
  const double clamped = above > 720.0 ? 720.0 : above;
  const double n = round_to_whole(clamped * (1.0 / kLn2));
  const double r = (clamped - n * kLn2High) - n * kLn2Low;
  const double half = round_to_whole(n * 0.5);
  return {two_to(half), two_to(n - half), r * exp_ratio_series(r)};
}

inline double exp(double x) noexcept {
  const ExpParts parts = exp_parts(x);
  return (parts.half_scale + parts.half_scale * parts.fraction) * parts.other_scale;
}

/// e^x - 1 without cancellation near 0.
inline double expm1(double x) noexcept {
  const ExpParts parts = exp_parts(x);
  const double scale = parts.half_scale * parts.other_scale;
  return scale == 1.0 || x != x ? parts.fraction : exp(x) - 1.0;
}

/// (e^x - 1) / x, 1 for x = 0.
inline double exp_ratio(double x) noexcept {
  const double near = exp_ratio_series(x);
  const double far = (exp(x) - 1.0) / x;
  const double size = x < 0 ? -x : x;
  return size < 0.34 ? near : far;
}

/// Natural logarithm: x = 2^e m with m in [sqrt(1/2), sqrt(2)), s = (m - 1) / (m + 1),
/// ln m = 2 (s + s^3/3 + s^5/5 + ...); |s| < 0.172, the first omitted term is below 2^-60.
inline double log(double x) noexcept {
  const bool is_subnormal = x < 0x1p-1022;
  const double scaled = is_subnormal ? x * 0x1p54 : x;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(scaled);
  // Adding this to the bits carries into the exponent exactly when the mantissa is at least sqrt(2).
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcdU;
  const std::uint64_t shifted = bits - kSqrtHalf;
  const auto exponent_bits = static_cast<std::int64_t>(shifted) >> 52U;
  const double m = std::bit_cast<double>(bits - (static_cast<std::uint64_t>(exponent_bits) << 52U));
  const double e = static_cast<double>(exponent_bits) - (is_subnormal ? 54.0 : 0.0);
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double sum = 1.0 / 23.0;
  sum = sum * z + 1.0 / 21.0;
  sum = sum * z + 1.0 / 19.0;
  sum = sum * z + 1.0 / 17.0;
  sum = sum * z + 1.0 / 15.0;
  sum = sum * z + 1.0 / 13.0;
  sum = sum * z + 1.0 / 11.0;
  sum = sum * z + 1.0 / 9.0;
  sum = sum * z + 1.0 / 7.0;
  sum = sum * z + 1.0 / 5.0;
  sum = sum * z + 1.0 / 3.0;
  const double tail = 2.0 * s * z * sum;
  const double value = e * kLn2High + (2.0 * s + (tail + e * kLn2Low));
  const double positive = x < kInfinity ? value : x;  // infinity and NaN stay
  const double defined = x < 0.0 ? kNaN : positive;
  return x == 0.0 ? -kInfinity : defined;
}

inline double log2(double x) noexcept {
  // Whole powers of two come out whole.
  const double rounded = round_to_whole(log(x) * (1.0 / kLn2));
  return rounded > -1022.0 && rounded < 1023.0 && two_to(rounded) == x ? rounded : log(x) * (1.0 / kLn2);
}
inline double log10(double x) noexcept { return log(x) * (1.0 / 2.30258509299404590109); }

/// a^b. Whole exponents up to 64 by repeated multiplication; otherwise e^(b ln |a|), whose relative
/// error grows as |b ln a|. A negative base needs a whole exponent.
inline double power(double a, double b) noexcept {
  const bool is_whole = std::floor(b) == b;
  if (is_whole && b >= -64.0 && b <= 64.0) {
    double result = 1.0;
    double square = a;
    for (auto n = static_cast<std::uint32_t>(b < 0 ? -b : b); n != 0; n >>= 1U) {
      if ((n & 1U) != 0) {
        result *= square;
      }
      square *= square;
    }
    return b < 0 ? 1.0 / result : result;
  }
  if (a == 0.0) {
    return b > 0 ? 0.0 : (b < 0 ? kInfinity : kNaN);
  }
  if (a > 0.0) {
    return exp(b * log(a));
  }
  if (!is_whole) {
    return kNaN;
  }
  const bool is_odd = std::floor(b * 0.5) * 2.0 != b;
  const double size = exp(b * log(-a));
  return is_odd ? -size : size;
}

/// Sine of r, cosine of r for |r| <= pi / 4: Taylor series, first omitted term below 2^-58.
inline double sin_series(double r) noexcept {
  const double z = r * r;
  double sum = 1.0 / 355687428096000.0;  // 1 / 17!
  sum = sum * z - 1.0 / 1307674368000.0;
  sum = sum * z + 1.0 / 6227020800.0;
  sum = sum * z - 1.0 / 39916800.0;
  sum = sum * z + 1.0 / 362880.0;
  sum = sum * z - 1.0 / 5040.0;
  sum = sum * z + 1.0 / 120.0;
  sum = sum * z - 1.0 / 6.0;
  return r + r * z * sum;
}
inline double cos_series(double r) noexcept {
  const double z = r * r;
  double sum = -1.0 / 6402373705728000.0;  // -1 / 18!
  sum = sum * z + 1.0 / 20922789888000.0;
  sum = sum * z - 1.0 / 87178291200.0;
  sum = sum * z + 1.0 / 479001600.0;
  sum = sum * z - 1.0 / 3628800.0;
  sum = sum * z + 1.0 / 40320.0;
  sum = sum * z - 1.0 / 720.0;
  sum = sum * z + 1.0 / 24.0;
  sum = sum * z - 0.5;
  return 1.0 + z * sum;
}

/// x = quadrant * pi/2 + remainder. pi/2 in three parts of 33 bits keeps the products exact for
/// |x| < 2^19; angles of neurons and eyes are far smaller. Beyond 2^30 the angle is called NaN.
struct QuarterTurn {
  std::uint32_t quadrant;
  double remainder;
};
inline QuarterTurn quarter_turn(double x) noexcept {
  if (!(x > -0x1p30 && x < 0x1p30)) {
    return {0, kNaN};
  }
  const double n = round_to_whole(x * (1.0 / kHalfPi));
  const double r = ((x - n * 0x1.921fb544p+0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69;
  return {static_cast<std::uint32_t>(static_cast<std::int64_t>(n) & 3), r};
}
inline double sin(double x) noexcept {
  const QuarterTurn turn = quarter_turn(x);
  const double size = (turn.quadrant & 1U) != 0 ? cos_series(turn.remainder) : sin_series(turn.remainder);
  return (turn.quadrant & 2U) != 0 ? -size : size;
}
inline double cos(double x) noexcept {
  const QuarterTurn turn = quarter_turn(x);
  const double size = (turn.quadrant & 1U) != 0 ? sin_series(turn.remainder) : cos_series(turn.remainder);
  return ((turn.quadrant + 1U) & 2U) != 0 ? -size : size;
}
inline double tan(double x) noexcept { return sin(x) / cos(x); }

/// Arc tangent: inverted above 1, then halved twice, which leaves |y| < 0.2 for the series.
inline double atan(double x) noexcept {
  const double size = x < 0 ? -x : x;
  double y = size > 1.0 ? 1.0 / size : size;
  y = y / (1.0 + std::sqrt(1.0 + y * y));
  y = y / (1.0 + std::sqrt(1.0 + y * y));
  const double z = y * y;
  double sum = 0;
  for (double k = 23.0; k > 1.0; k -= 2.0) {
    sum = 1.0 / k - z * sum;
  }
  const double small = 4.0 * (y - y * z * sum);
  const double angle = size > 1.0 ? kHalfPi - small : small;
  return x < 0 ? -angle : angle;
}
inline double atan2(double y, double x) noexcept {
  if (x == 0.0) {
    return y > 0 ? kHalfPi : (y < 0 ? -kHalfPi : (y == y ? 0.0 : y));
  }
  const double angle = atan(y / x);
  return x > 0 ? angle : (y < 0 ? angle - kPi : angle + kPi);
}
inline double asin(double x) noexcept { return atan2(x, std::sqrt((1.0 - x) * (1.0 + x))); }
inline double acos(double x) noexcept { return atan2(std::sqrt((1.0 - x) * (1.0 + x)), x); }

inline double tanh(double x) noexcept {
  const double size = x < 0 ? -x : x;
  const double growth = expm1(2.0 * (size > 20.0 ? 20.0 : size));  // beyond 20 it is 1 to the last bit
  const double value = growth / (growth + 2.0);
  return x != x ? x : (x < 0 ? -value : value);
}
inline double hypot(double a, double b) noexcept { return std::sqrt(a * a + b * b); }
inline double mod(double a, double b) noexcept { return a - b * std::floor(a / b); }
inline double sign(double x) noexcept { return x > 0 ? 1.0 : (x < 0 ? -1.0 : 0.0); }

}  // namespace tectum::portable
