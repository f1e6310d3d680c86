#include "tools/circuit_tests/bound.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>

namespace tectum {
namespace {

/// Bytes [begin, end) of a value's text without the blanks around, as a value of its own place.
ValueDecl part_of(const ValueDecl& whole, std::size_t begin, std::size_t end) {
  while (begin < end && whole.text[begin] == ' ') {
    ++begin;
  }
  while (end > begin && whole.text[end - 1] == ' ') {
    --end;
  }
  ValueDecl part = whole;
  part.is_number = false;
  part.text = whole.text.substr(begin, end - begin);
  if (whole.has_exact_offsets) {
    part.span.begin = whole.span.begin + static_cast<std::uint32_t>(begin);
    part.span.end = whole.span.begin + static_cast<std::uint32_t>(end);
  }
  return part;
}

/// "deg" of "10 deg"; empty for a plain number.
std::string unit_of(const std::string& text) {
  std::size_t at = 0;
  while (at < text.size() && std::string_view("+-0123456789.eE ").find(text[at]) != std::string_view::npos) {
    const bool is_exponent = text[at] == 'e' || text[at] == 'E';
    if (is_exponent && (at + 1 >= text.size() || std::isalpha(static_cast<unsigned char>(text[at + 1])) != 0)) {
      break;
    }
    ++at;
  }
  return text.substr(at);
}

ValueDecl with_unit(ValueDecl value, const std::string& unit) {
  if (!unit.empty() && unit_of(value.text).empty()) {
    value.text += " " + unit;
    value.has_exact_offsets = false;
  }
  return value;
}

struct Split {
  std::size_t at = std::string::npos;
  std::size_t length = 0;
};

Split find_sign(const std::string& text, std::initializer_list<std::string_view> signs) {
  for (const std::string_view sign : signs) {
    const std::size_t at = text.find(sign);
    if (at != std::string::npos) {
      return {at, sign.size()};
    }
  }
  return {};
}

class BoundReader {
 public:
  BoundReader(const ValueDecl& value, std::string_view key, const Dimension& dimension, Scope& scope)
      : value_(value), key_(key), dimension_(dimension), scope_(scope) {}

  std::optional<Bound> read() {
    const std::string& text = value_.text;
    bound_.text = text;
    if (!text.empty() && (text[0] == '<' || text[0] == '>')) {
      return one_sided(text.size() > 1 && text[1] == '=' ? 2 : 1);
    }
    if (const Split sign = find_sign(text, {"±", "+-", "+/-"}); sign.length > 0) {
      return around(sign);
    }
    if (const Split sign = find_sign(text, {" to "}); sign.length > 0) {
      return between(sign);
    }
    const std::string unit = display_unit(dimension_);
    const auto with = [&](const char* number) { return unit.empty() ? number : fmt::format("{} {}", number, unit); };
    scope_.diagnostics()
        .add(Code::UnexpectedToken, value_.span,
             {fmt::format("a bound on `{}`", key_), value_.is_number ? text : fmt::format("`{}`", text)})
        .help(fmt::format(R"(write "< {}", "{} ± 1" or "8 to {}")", with("10"), with("10"), with("12")));
    return std::nullopt;
  }

 private:
  std::optional<double> number(const ValueDecl& value) { return scope_.constant(value, key_, dimension_); }

  std::optional<Bound> one_sided(std::size_t sign_length) {
    const std::optional<double> limit = number(part_of(value_, sign_length, value_.text.size()));
    if (!limit) {
      return std::nullopt;
    }
    (value_.text[0] == '<' ? bound_.high : bound_.low) = *limit;
    bound_.excludes_ends = sign_length == 1;
    return bound_;
  }

  std::optional<Bound> around(const Split& sign) {
    const ValueDecl left = part_of(value_, 0, sign.at);
    const ValueDecl right = part_of(value_, sign.at + sign.length, value_.text.size());
    const std::optional<double> middle = number(left);
    if (!middle) {
      return std::nullopt;
    }
    const bool is_relative = right.text.ends_with('%') && !unit_of(left.text).ends_with('%');
    const std::optional<double> tolerance =
        is_relative ? scope_.constant(right, key_, kNumber) : number(with_unit(right, unit_of(left.text)));
    if (!tolerance) {
      return std::nullopt;
    }
    const double reach = std::abs(is_relative ? *tolerance * *middle : *tolerance);
    bound_.low = *middle - reach;
    bound_.high = *middle + reach;
    return bound_;
  }

  std::optional<Bound> between(const Split& sign) {
    const ValueDecl left = part_of(value_, 0, sign.at);
    const ValueDecl right = part_of(value_, sign.at + sign.length, value_.text.size());
    const std::optional<double> high = number(right);
    const std::optional<double> low = high ? number(with_unit(left, unit_of(right.text))) : std::nullopt;
    if (!low) {
      return std::nullopt;
    }
    if (*low > *high) {
      scope_.diagnostics().add(Code::RangeReversed, value_.span, {fmt::format("`{}`", key_), left.text, right.text});
      return std::nullopt;
    }
    bound_.low = *low;
    bound_.high = *high;
    return bound_;
  }

  const ValueDecl& value_;
  std::string_view key_;
  const Dimension& dimension_;
  Scope& scope_;
  Bound bound_;
};

}  // namespace

std::optional<Bound> read_bound(const ValueDecl& value, std::string_view key, const Dimension& dimension,
                                Scope& scope) {
  if (value.is_poisoned) {
    return std::nullopt;
  }
  return BoundReader(value, key, dimension, scope).read();
}

std::string seen_text(double coherent, const Dimension& dimension, bool is_share) {
  if (is_share) {
    return fmt::format("{:.4g} %", 100 * coherent);
  }
  const std::string unit = display_unit(dimension);
  const std::optional<Unit> parsed = parse_unit(unit);
  const double number = parsed ? from_coherent(coherent, *parsed) : coherent;
  return unit.empty() ? fmt::format("{:.4g}", number) : fmt::format("{:.4g} {}", number, unit);
}

}  // namespace tectum
