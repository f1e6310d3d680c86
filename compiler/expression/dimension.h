// Dimensions and units: what a number in a circuit file measures.
//
// Six base dimensions with integer exponents. The coherent internal units are
//
//   time ms · voltage mV · current nA · angle deg · length m · pixels px
//
// from which follow  resistance MOhm = mV/nA · capacitance nF = nA ms/mV · conductance uS = nA/mV ·
// charge pC = nA ms · frequency kHz = 1/ms. A frequency is thus held in 1/ms: convert with in_hz()
// where it leaves the expression layer. Percent is the plain number 0.01.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tectum {

enum class BaseDimension : std::uint8_t { Time, Voltage, Current, Angle, Length, Pixels };
inline constexpr std::size_t kBaseDimensionCount = 6;

/// What a value is: a quantity with exponents, a truth value, or one of the circuit's words
/// (left, up, ...). Exponents are all zero unless the kind is Quantity.
struct Dimension {
  enum class Kind : std::uint8_t { Quantity, Boolean, Word };
  Kind kind = Kind::Quantity;
  std::array<std::int8_t, kBaseDimensionCount> exponents{};

  friend bool operator==(const Dimension&, const Dimension&) = default;
  [[nodiscard]] bool is_number() const { return *this == Dimension{}; }
};

/// Base dimension `base` to the power `exponent`.
constexpr Dimension base_dimension(BaseDimension base, std::int8_t exponent = 1) {
  Dimension d;
  d.exponents[static_cast<std::size_t>(base)] = exponent;
  return d;
}

/// Product, quotient, power, n-th root. Empty when an exponent would leave -100..100 or stop
/// being whole. Both sides must be quantities.
std::optional<Dimension> multiply(const Dimension& a, const Dimension& b);
std::optional<Dimension> divide(const Dimension& a, const Dimension& b);
std::optional<Dimension> power(const Dimension& base, int exponent);
std::optional<Dimension> root(const Dimension& radicand, int degree);

// The dimensions that the language names. kHz-based values: see in_hz().
inline constexpr Dimension kNumber{};
inline constexpr Dimension kBoolean{Dimension::Kind::Boolean, {}};
inline constexpr Dimension kWord{Dimension::Kind::Word, {}};
//                                                           T   V   I   angle L px
inline constexpr Dimension kTime{Dimension::Kind::Quantity, {1, 0, 0, 0, 0, 0}};               // ms
inline constexpr Dimension kVoltage{Dimension::Kind::Quantity, {0, 1, 0, 0, 0, 0}};            // mV
inline constexpr Dimension kCurrent{Dimension::Kind::Quantity, {0, 0, 1, 0, 0, 0}};            // nA
inline constexpr Dimension kAngle{Dimension::Kind::Quantity, {0, 0, 0, 1, 0, 0}};              // deg
inline constexpr Dimension kLength{Dimension::Kind::Quantity, {0, 0, 0, 0, 1, 0}};             // m
inline constexpr Dimension kPixels{Dimension::Kind::Quantity, {0, 0, 0, 0, 0, 1}};             // px
inline constexpr Dimension kFrequency{Dimension::Kind::Quantity, {-1, 0, 0, 0, 0, 0}};         // 1/ms
inline constexpr Dimension kResistance{Dimension::Kind::Quantity, {0, 1, -1, 0, 0, 0}};        // MOhm
inline constexpr Dimension kConductance{Dimension::Kind::Quantity, {0, -1, 1, 0, 0, 0}};       // uS
inline constexpr Dimension kCapacitance{Dimension::Kind::Quantity, {1, -1, 1, 0, 0, 0}};       // nF
inline constexpr Dimension kCharge{Dimension::Kind::Quantity, {1, 0, 1, 0, 0, 0}};             // pC
inline constexpr Dimension kVoltageRate{Dimension::Kind::Quantity, {-1, 1, 0, 0, 0, 0}};       // mV/ms
inline constexpr Dimension kAngularVelocity{Dimension::Kind::Quantity, {-1, 0, 0, 1, 0, 0}};   // deg/ms
inline constexpr Dimension kAnglePerFrequency{Dimension::Kind::Quantity, {1, 0, 0, 1, 0, 0}};  // deg ms

/// Coherent frequency (1/ms) to hertz and back.
constexpr double in_hz(double per_ms) { return per_ms * 1000.0; }
constexpr double from_hz(double hz) { return hz / 1000.0; }

/// For messages: "voltage (mV)", "frequency (Hz)", "number", "mV/ms^2", "truth value", "word".
std::string describe(const Dimension& dimension);
/// The unit in which values of this dimension are shown: "mV", "Hz", "deg/s", "" for a number.
std::string display_unit(const Dimension& dimension);

/// A parsed unit: coherent value = number * factor * 10^power_of_ten. The power of ten is kept
/// apart so that "900 pA" is 900 / 1000 = 0.9 nA to the last bit.
struct Unit {
  Dimension dimension;
  int power_of_ten = 0;
  double factor = 1;
  friend bool operator==(const Unit&, const Unit&) = default;
};

/// One unit name ("mV", "deg", "%", "Ω"), not a product.
std::optional<Unit> find_unit(std::string_view name);
/// A product of unit names: "mV/ms", "deg/s/Hz", "1/ms", "nA*s", "m^2"; "" and "1" are the number one.
/// Empty when any part is not a unit.
std::optional<Unit> parse_unit(std::string_view text);
/// The unit name nearest to a misspelt one, if any is near.
std::optional<std::string> suggest_unit(std::string_view misspelt);

/// number * unit in coherent units, and back.
double to_coherent(double number, const Unit& unit);
double from_coherent(double coherent, const Unit& unit);

}  // namespace tectum
