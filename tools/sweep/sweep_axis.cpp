#include "tools/sweep/sweep_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

namespace tectum {
namespace {

struct Quantity {
  double number = 0;
  std::string unit;
};

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  const std::size_t last = text.find_last_not_of(' ');
  return first == std::string_view::npos ? "" : std::string(text.substr(first, last - first + 1));
}

std::optional<Quantity> read_quantity(std::string_view given) {
  const std::string text = trimmed(given);
  Quantity quantity;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, quantity.number);
  if (error != std::errc{} || !std::isfinite(quantity.number)) {
    return std::nullopt;
  }
  quantity.unit = trimmed({rest, static_cast<std::size_t>(end - rest)});
  const bool is_unit = quantity.unit.find_first_of(".:") == std::string::npos;
  return is_unit ? std::optional(quantity) : std::nullopt;
}

/// Twelve digits: what is left of 0.1 + 0.2 after that is rounding, and would only be noise in names and tables.
std::string text_of(double number, const std::string& unit) {
  return fmt::format("{:.12g}{}{}", number, unit.empty() ? "" : " ", unit);
}

bool is_whole(double number) { return number == std::floor(number); }

/// Returns what is wrong.
std::string add_range(std::string_view item, std::size_t dots, std::vector<std::string>& values) {
  const std::size_t colon = item.find(':', dots);
  const std::string_view tail = item.substr(dots + 2, colon == std::string_view::npos ? colon : colon - dots - 2);
  const std::optional<Quantity> low = read_quantity(item.substr(0, dots));
  const std::optional<Quantity> high = read_quantity(tail);
  if (!low || !high) {
    return fmt::format("`{}` is no range; write 0.5..1.5:11 or 0..9", item);
  }
  if (!low->unit.empty() && !high->unit.empty() && low->unit != high->unit) {
    return fmt::format("`{}` begins in {} and ends in {}", item, low->unit, high->unit);
  }
  const std::string& unit = low->unit.empty() ? high->unit : low->unit;
  double count = high->number - low->number + 1;
  if (colon == std::string_view::npos) {
    if (!is_whole(low->number) || !is_whole(high->number)) {
      return fmt::format("`{}` does not say how many values; write {}:11 for eleven", item, item);
    }
    if (count < 1) {
      return fmt::format("`{}` runs downwards; write {}..{}", item, high->number, low->number);
    }
  } else {
    const std::optional<Quantity> given = read_quantity(item.substr(colon + 1));
    if (!given || !given->unit.empty() || !is_whole(given->number) || given->number < 2) {
      return fmt::format("`{}` is no count of values; at least 2", item.substr(colon + 1));
    }
    count = given->number;
  }
  if (count > static_cast<double>(kMostPoints)) {
    return fmt::format("`{}` has more than {} values", item, kMostPoints);
  }
  const double step = count > 1 ? (high->number - low->number) / (count - 1) : 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    values.push_back(text_of(low->number + step * static_cast<double>(k), unit));
  }
  return "";
}

std::string add_item(std::string_view item, std::vector<std::string>& values) {
  const std::size_t dots = item.find("..");
  if (dots != std::string_view::npos) {
    return add_range(item, dots, values);
  }
  const std::string value = trimmed(item);
  if (value.empty()) {
    return "a value between two commas is missing";
  }
  const std::optional<Quantity> quantity = read_quantity(value);
  values.push_back(quantity ? text_of(quantity->number, quantity->unit) : value);
  return "";
}

std::string seed_problem(const SweepAxis& axis) {
  for (const std::string& value : axis.values) {
    if (value.empty() || value.size() > 18 || value.find_first_not_of("0123456789") != std::string::npos) {
      return fmt::format("seed `{}` is no whole number from 0 on", value);
    }
  }
  return "";
}

}  // namespace

ReadAxis read_axis(const std::string& text) {
  const std::size_t equals = text.find('=');
  SweepAxis axis;
  axis.name = trimmed(std::string_view(text).substr(0, equals));
  if (equals == std::string::npos || axis.name.empty()) {
    return {std::nullopt, fmt::format("-p {}: expected NAME=VALUES, such as -p error_gain=0.3..0.5nA/deg:5", text)};
  }
  std::string_view rest = std::string_view(text).substr(equals + 1);
  while (true) {
    const std::size_t comma = rest.find(',');
    const std::string problem = add_item(rest.substr(0, comma), axis.values);
    if (!problem.empty()) {
      return {std::nullopt, fmt::format("-p {}: {}", text, problem)};
    }
    if (comma == std::string_view::npos) {
      break;
    }
    rest.remove_prefix(comma + 1);
  }
  const std::set<std::string> distinct(axis.values.begin(), axis.values.end());
  if (distinct.size() != axis.values.size()) {
    return {std::nullopt, fmt::format("-p {}: a value stands there twice", text)};
  }
  if (axis.name == kSeedAxis) {
    const std::string problem = seed_problem(axis);
    if (!problem.empty()) {
      return {std::nullopt, fmt::format("-p {}: {}", text, problem)};
    }
  }
  return {axis, ""};
}

std::string axes_problem(const std::vector<SweepAxis>& axes) {
  std::set<std::string> names;
  std::size_t points = 1;
  for (const SweepAxis& axis : axes) {
    if (!names.insert(axis.name).second) {
      return fmt::format("`{}` is swept twice", axis.name);
    }
    points *= axis.values.size();  // at most kMostPoints squared: no overflow
    if (points > kMostPoints) {
      return fmt::format("these are more than {} runs", kMostPoints);
    }
  }
  return "";
}

std::vector<SweepPoint> points_of(const std::vector<SweepAxis>& axes) {
  std::vector<SweepPoint> points = {{}};
  for (const SweepAxis& axis : axes) {
    std::vector<SweepPoint> longer;
    for (const SweepPoint& point : points) {
      for (std::size_t value = 0; value < axis.values.size(); ++value) {
        longer.push_back(point);
        longer.back().push_back(value);
      }
    }
    points = std::move(longer);
  }
  return points;
}

}  // namespace tectum
