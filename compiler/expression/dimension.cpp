#include "compiler/expression/dimension.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "compiler/expression/expression.h"
#include "compiler/expression/functions.h"
#include "compiler/expression/quantity.h"

namespace tectum {
namespace {

constexpr int kMaxExponent = 100;

struct NamedUnit {
  std::string_view name;
  Unit unit;
};

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

// Powers of ten are relative to the coherent units ms, mV, nA, deg, m, px.
constexpr NamedUnit kUnits[] = {
    {"s", {kTime, 3, 1}},
    {"ms", {kTime, 0, 1}},
    {"us", {kTime, -3, 1}},
    {"µs", {kTime, -3, 1}},
    {"μs", {kTime, -3, 1}},
    {"ns", {kTime, -6, 1}},
    {"V", {kVoltage, 3, 1}},
    {"mV", {kVoltage, 0, 1}},
    {"uV", {kVoltage, -3, 1}},
    {"µV", {kVoltage, -3, 1}},
    {"μV", {kVoltage, -3, 1}},
    {"A", {kCurrent, 9, 1}},
    {"mA", {kCurrent, 6, 1}},
    {"uA", {kCurrent, 3, 1}},
    {"µA", {kCurrent, 3, 1}},
    {"μA", {kCurrent, 3, 1}},
    {"nA", {kCurrent, 0, 1}},
    {"pA", {kCurrent, -3, 1}},
    {"Ohm", {kResistance, -6, 1}},
    {"kOhm", {kResistance, -3, 1}},
    {"MOhm", {kResistance, 0, 1}},
    {"GOhm", {kResistance, 3, 1}},
    {"Ω", {kResistance, -6, 1}},
    {"kΩ", {kResistance, -3, 1}},
    {"MΩ", {kResistance, 0, 1}},
    {"GΩ", {kResistance, 3, 1}},
    {"S", {kConductance, 6, 1}},
    {"mS", {kConductance, 3, 1}},
    {"uS", {kConductance, 0, 1}},
    {"µS", {kConductance, 0, 1}},
    {"μS", {kConductance, 0, 1}},
    {"nS", {kConductance, -3, 1}},
    {"pS", {kConductance, -6, 1}},
    {"F", {kCapacitance, 9, 1}},
    {"uF", {kCapacitance, 3, 1}},
    {"µF", {kCapacitance, 3, 1}},
    {"μF", {kCapacitance, 3, 1}},
    {"nF", {kCapacitance, 0, 1}},
    {"pF", {kCapacitance, -3, 1}},
    {"nC", {kCharge, 3, 1}},
    {"pC", {kCharge, 0, 1}},
    {"fC", {kCharge, -3, 1}},
    {"Hz", {kFrequency, -3, 1}},
    {"kHz", {kFrequency, 0, 1}},
    {"MHz", {kFrequency, 3, 1}},
    {"deg", {kAngle, 0, 1}},
    {"°", {kAngle, 0, 1}},
    {"rad", {kAngle, 0, kDegPerRad}},
    {"mrad", {kAngle, -3, kDegPerRad}},
    {"arcmin", {kAngle, 0, 1.0 / 60.0}},
    {"arcsec", {kAngle, 0, 1.0 / 3600.0}},
    {"m", {kLength, 0, 1}},
    {"cm", {kLength, -2, 1}},
    {"mm", {kLength, -3, 1}},
    {"um", {kLength, -6, 1}},
    {"µm", {kLength, -6, 1}},
    {"μm", {kLength, -6, 1}},
    {"px", {kPixels, 0, 1}},
    {"%", {kNumber, -2, 1}},
};

// Written-out names that people type instead.
constexpr std::pair<std::string_view, std::string_view> kSynonyms[] = {
    {"sec", "s"},          {"second", "s"},        {"seconds", "s"},     {"msec", "ms"},     {"usec", "us"},
    {"millisecond", "ms"}, {"milliseconds", "ms"}, {"volt", "V"},        {"volts", "V"},     {"millivolt", "mV"},
    {"millivolts", "mV"},  {"amp", "A"},           {"ampere", "A"},      {"nanoamp", "nA"},  {"ohms", "Ohm"},
    {"degree", "deg"},     {"degrees", "deg"},     {"radian", "rad"},    {"radians", "rad"}, {"hertz", "Hz"},
    {"pixel", "px"},       {"pixels", "px"},       {"percent", "%"},     {"meter", "m"},     {"metre", "m"},
    {"siemens", "S"},      {"farad", "F"},         {"minute", "arcmin"},
};

struct NamedDimension {
  Dimension dimension;
  std::string_view noun;
  std::string_view unit;
};

constexpr NamedDimension kNamed[] = {
    {kTime, "time", "ms"},
    {kVoltage, "voltage", "mV"},
    {kCurrent, "current", "nA"},
    {kAngle, "angle", "deg"},
    {kLength, "length", "m"},
    {kPixels, "pixels", "px"},
    {kFrequency, "frequency", "Hz"},
    {kResistance, "resistance", "MOhm"},
    {kConductance, "conductance", "uS"},
    {kCapacitance, "capacitance", "nF"},
    {kCharge, "charge", "pC"},
    {kVoltageRate, "voltage per time", "mV/ms"},
    {kAngularVelocity, "angular velocity", "deg/s"},
    {kAnglePerFrequency, "angle per frequency", "deg/Hz"},
};

const NamedDimension* find_named(const Dimension& dimension) {
  for (const NamedDimension& named : kNamed) {
    if (named.dimension == dimension) {
      return &named;
    }
  }
  return nullptr;
}

std::optional<Dimension> combine(const Dimension& a, const Dimension& b, int sign) {
  Dimension result;
  for (std::size_t i = 0; i < kBaseDimensionCount; ++i) {
    const int exponent = a.exponents[i] + sign * b.exponents[i];
    if (exponent < -kMaxExponent || exponent > kMaxExponent) {
      return std::nullopt;
    }
    result.exponents[i] = static_cast<std::int8_t>(exponent);
  }
  return result;
}

void append_factor(std::string& text, std::string_view unit, int exponent) {
  if (!text.empty()) {
    text += '*';
  }
  text += unit;
  if (exponent != 1) {
    text += "^" + std::to_string(exponent);
  }
}

// "mV*nA/ms^2" from the coherent base units; a lone denominator reads "1/ms^2".
std::string coherent_unit(const Dimension& dimension) {
  constexpr std::string_view kBaseUnits[kBaseDimensionCount] = {"ms", "mV", "nA", "deg", "m", "px"};
  std::string above;
  std::string below;
  for (std::size_t i = 0; i < kBaseDimensionCount; ++i) {
    const int exponent = dimension.exponents[i];
    if (exponent > 0) {
      append_factor(above, kBaseUnits[i], exponent);
    }
    if (exponent < 0) {
      below += "/" + std::string(kBaseUnits[i]) + (exponent == -1 ? "" : "^" + std::to_string(-exponent));
    }
  }
  if (below.empty()) {
    return above;
  }
  return (above.empty() ? "1" : above) + below;
}

constexpr bool is_unit_byte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || static_cast<unsigned char>(c) >= 0x80;
}

// Reads the factors of a product of units one after the other.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : text_(text) {}

  std::optional<Unit> read() {
    Unit product;
    skip_blanks();
    if (at_ == text_.size()) {
      return product;
    }
    if (!factor(product, 1)) {
      return std::nullopt;
    }
    for (skip_blanks(); at_ < text_.size(); skip_blanks()) {
      const char sign = text_[at_++];
      if (sign != '*' && sign != '/') {
        return std::nullopt;
      }
      skip_blanks();
      if (!factor(product, sign == '*' ? 1 : -1)) {
        return std::nullopt;
      }
    }
    return product;
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && text_[at_] == ' ') {
      ++at_;
    }
  }

  bool factor(Unit& product, int sign) {
    if (at_ < text_.size() && text_[at_] == '1') {
      ++at_;
      return true;
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_unit_byte(text_[at_])) {
      ++at_;
    }
    const std::optional<Unit> unit = find_unit(text_.substr(begin, at_ - begin));
    if (!unit) {
      return false;
    }
    int exponent = 1;
    if (at_ < text_.size() && text_[at_] == '^') {
      const char* first = text_.data() + at_ + 1;
      const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), exponent);
      if (error != std::errc{} || exponent < -kMaxExponent || exponent > kMaxExponent) {
        return false;
      }
      at_ = static_cast<std::size_t>(end - text_.data());
    }
    return accumulate(product, *unit, sign * exponent);
  }

  static bool accumulate(Unit& product, const Unit& unit, int exponent) {
    const std::optional<Dimension> raised = power(unit.dimension, exponent);
    const std::optional<Dimension> dimension = raised ? multiply(product.dimension, *raised) : std::nullopt;
    if (!dimension) {
      return false;
    }
    product.dimension = *dimension;
    product.power_of_ten += unit.power_of_ten * exponent;
    // By repeated multiplication: exact for the factor 1 that nearly every unit has.
    for (int i = 0; i < exponent; ++i) {
      product.factor *= unit.factor;
    }
    for (int i = 0; i > exponent; --i) {
      product.factor /= unit.factor;
    }
    constexpr int kMaxPowerOfTen = 300;
    return std::abs(product.power_of_ten) <= kMaxPowerOfTen && std::isfinite(product.factor) && product.factor > 0;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

// 10^exponent, exact up to 22 and within a unit in the last place beyond.
double ten_to(int exponent) {
  double result = 1;
  for (int i = 0; i < exponent; ++i) {
    result *= 10;
  }
  return result;
}

double shift_decimal(double value, int places) {
  return places >= 0 ? value * ten_to(places) : value / ten_to(-places);
}

}  // namespace

std::optional<Dimension> multiply(const Dimension& a, const Dimension& b) { return combine(a, b, 1); }

std::optional<Dimension> divide(const Dimension& a, const Dimension& b) { return combine(a, b, -1); }

std::optional<Dimension> power(const Dimension& base, int exponent) {
  if (base.is_number()) {
    return base;
  }
  if (exponent < -kMaxExponent || exponent > kMaxExponent) {
    return std::nullopt;
  }
  Dimension result;
  for (std::size_t i = 0; i < kBaseDimensionCount; ++i) {
    const int raised = base.exponents[i] * exponent;
    if (raised < -kMaxExponent || raised > kMaxExponent) {
      return std::nullopt;
    }
    result.exponents[i] = static_cast<std::int8_t>(raised);
  }
  return result;
}

std::optional<Dimension> root(const Dimension& radicand, int degree) {
  Dimension result;
  for (std::size_t i = 0; i < kBaseDimensionCount; ++i) {
    if (radicand.exponents[i] % degree != 0) {
      return std::nullopt;
    }
    result.exponents[i] = static_cast<std::int8_t>(radicand.exponents[i] / degree);
  }
  return result;
}

std::string describe(const Dimension& dimension) {
  if (dimension.kind == Dimension::Kind::Boolean) {
    return "truth value";
  }
  if (dimension.kind == Dimension::Kind::Word) {
    return "word";
  }
  if (dimension.is_number()) {
    return "number";
  }
  if (const NamedDimension* named = find_named(dimension)) {
    return std::string(named->noun) + " (" + std::string(named->unit) + ")";
  }
  return coherent_unit(dimension);
}

std::string display_unit(const Dimension& dimension) {
  if (dimension.kind != Dimension::Kind::Quantity) {
    return "";
  }
  if (const NamedDimension* named = find_named(dimension)) {
    return std::string(named->unit);
  }
  return coherent_unit(dimension);
}

std::optional<Unit> find_unit(std::string_view name) {
  for (const NamedUnit& unit : kUnits) {
    if (unit.name == name) {
      return unit.unit;
    }
  }
  return std::nullopt;
}

std::optional<Unit> parse_unit(std::string_view text) { return UnitReader(text).read(); }

std::optional<std::string> suggest_unit(std::string_view misspelt) {
  for (const auto& [synonym, unit] : kSynonyms) {
    if (synonym == misspelt) {
      return std::string(unit);
    }
  }
  std::vector<std::string> names;
  for (const NamedUnit& unit : kUnits) {
    names.emplace_back(unit.name);
  }
  return nearest_name(misspelt, names);
}

double to_coherent(double number, const Unit& unit) { return shift_decimal(number * unit.factor, unit.power_of_ten); }

double from_coherent(double coherent, const Unit& unit) {
  return shift_decimal(coherent, -unit.power_of_ten) / unit.factor;
}

std::string format_quantity(const Quantity& quantity) {
  if (quantity.dimension == kBoolean) {
    return quantity.value != 0 ? "true" : "false";
  }
  const std::string unit_text = display_unit(quantity.dimension);
  const Unit unit = parse_unit(unit_text).value_or(Unit{});
  char buffer[40];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof(buffer), from_coherent(quantity.value, unit));
  const std::string number(buffer, error == std::errc{} ? end : buffer);
  return unit_text.empty() ? number : number + " " + unit_text;
}

std::vector<std::pair<std::string_view, std::string>> expression_units() {
  std::vector<std::pair<std::string_view, std::string>> units;
  for (const NamedUnit& unit : kUnits) {
    units.emplace_back(unit.name, describe(unit.unit.dimension));
  }
  return units;
}

}  // namespace tectum
