// Our own elementary functions against libm, and their edges.
#include "runtime/engine/portable_math.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>

using namespace tectum;

namespace {

// Distance in units in the last place of `expected`.
double ulps(double actual, double expected) {
  if (actual == expected) {
    return 0;
  }
  const double unit = std::nextafter(std::abs(expected), INFINITY) - std::abs(expected);
  return std::abs(actual - expected) / unit;
}

template <typename Ours, typename Theirs>
double worst_ulps(double low, double high, Ours ours, Theirs theirs) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> draw(low, high);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const double x = draw(random);
    const double distance = ulps(ours(x), theirs(x));
    worst = std::max(worst, std::isnan(distance) ? 1e9 : distance);
  }
  return worst;
}

}  // namespace

TEST_CASE("accuracy over the ranges of neuron models") {
  const auto libm = [](auto f) { return [f](double x) { return f(x); }; };
  CHECK(worst_ulps(-700, 700, portable::exp, libm([](double x) { return std::exp(x); })) < 2);
  CHECK(worst_ulps(-1, 1, portable::exp, libm([](double x) { return std::exp(x); })) < 2);
  CHECK(worst_ulps(-2, 2, portable::expm1, libm([](double x) { return std::expm1(x); })) < 5);
  CHECK(worst_ulps(-3, 3, portable::exp_ratio, libm([](double x) { return std::expm1(x) / x; })) < 5);
  CHECK(worst_ulps(1e-3, 1e3, portable::log, libm([](double x) { return std::log(x); })) < 3);
  CHECK(worst_ulps(1e-300, 1e300, portable::log, libm([](double x) { return std::log(x); })) < 2);
  CHECK(worst_ulps(0, 1000, portable::log2, libm([](double x) { return std::log2(x); })) < 4);
  CHECK(worst_ulps(0, 1000, portable::log10, libm([](double x) { return std::log10(x); })) < 4);
  CHECK(worst_ulps(-20, 20, portable::tanh, libm([](double x) { return std::tanh(x); })) < 4);
  CHECK(worst_ulps(-50, 50, portable::atan, libm([](double x) { return std::atan(x); })) < 4);
  CHECK(worst_ulps(-1, 1, portable::asin, libm([](double x) { return std::asin(x); })) < 6);
  CHECK(worst_ulps(-0.99, 0.99, portable::acos, libm([](double x) { return std::acos(x); })) < 6);
  const auto root = [](double x) { return portable::power(x, 0.3); };
  CHECK(worst_ulps(0, 100, root, libm([](double x) { return std::pow(x, 0.3); })) < 4);
  const auto cube = [](double x) { return portable::power(x, 3); };
  CHECK(worst_ulps(-100, 100, cube, libm([](double x) { return std::pow(x, 3); })) < 2);
}

TEST_CASE("sine and cosine are accurate to 2^-52 absolutely") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> draw(-1000, 1000);
  for (int i = 0; i < 200000; ++i) {
    const double x = draw(random);
    REQUIRE(std::abs(portable::sin(x) - std::sin(x)) < 0x1p-52);
    REQUIRE(std::abs(portable::cos(x) - std::cos(x)) < 0x1p-52);
  }
}

TEST_CASE("edges") {
  using namespace portable;
  CHECK(portable::exp(0) == 1);
  CHECK(portable::exp(1000) == kInfinity);
  CHECK(portable::exp(kInfinity) == kInfinity);
  CHECK(portable::exp(-1000) == 0);
  CHECK(portable::exp(-kInfinity) == 0);
  CHECK(portable::exp(-740) == doctest::Approx(std::exp(-740)).epsilon(0.02));  // subnormal: few bits
  CHECK(std::isnan(portable::exp(kNaN)));
  CHECK(exp_ratio(0) == 1);
  CHECK(exp_ratio(-1000) == 0.001);
  CHECK(portable::log(0) == -kInfinity);
  CHECK(portable::log(kInfinity) == kInfinity);
  CHECK(std::isnan(portable::log(-1)));
  CHECK(std::isnan(portable::log(kNaN)));
  CHECK(portable::log(1) == 0);
  CHECK(portable::log(0x1p-1070) == doctest::Approx(-1070 * std::log(2.0)));
  CHECK(portable::log2(8) == 3);
  CHECK(portable::log2(0x1p-20) == -20);
  CHECK(power(2, 10) == 1024);
  CHECK(power(2, -2) == 0.25);
  CHECK(power(0, 0) == 1);
  CHECK(power(0, 0.5) == 0);
  CHECK(power(-2, 3) == -8);
  CHECK(power(-1, 1001) == -1);
  CHECK(std::isnan(power(-2, 0.5)));
  CHECK(portable::atan2(1, 1) == doctest::Approx(kPi / 4));
  CHECK(portable::atan2(1, -1) == doctest::Approx(3 * kPi / 4));
  CHECK(portable::atan2(-1, -1) == doctest::Approx(-3 * kPi / 4));
  CHECK(portable::atan2(0, 0) == 0);
  CHECK(portable::tanh(1000) == 1);
  CHECK(portable::tanh(-1e-9) == doctest::Approx(-1e-9));
  CHECK(std::isnan(portable::sin(1e300)));
  CHECK(mod(-1, 4) == 3);
}

TEST_CASE("the bits are pinned: another machine that differs fails here") {
  // FNV-1a over the results of a fixed sweep.
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto mix = [&hash](double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    for (int k = 0; k < 8; ++k) {
      hash = (hash ^ ((bits >> (8 * k)) & 255U)) * 0x100000001b3U;
    }
  };
  for (int i = -2000; i <= 2000; ++i) {
    const double x = i * 0.0137;
    mix(portable::exp(x));
    mix(portable::log(x * x + 0.01));
    mix(portable::sin(x));
    mix(portable::cos(x));
    mix(portable::atan(x));
    mix(portable::tanh(x));
    mix(portable::power(x * x, 0.37));
  }
  CHECK(hash == 7346605478731499642U);
}
