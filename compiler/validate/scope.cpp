#include "compiler/validate/scope.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace tectum {
namespace {

Code code_of(ExprErrorCode code) {
  switch (code) {
    case ExprErrorCode::UnknownUnit:
    case ExprErrorCode::AmbiguousUnit:
      return Code::UnknownUnit;
    case ExprErrorCode::UnknownName:
      return Code::UnknownName;
    case ExprErrorCode::UnknownFunction:
    case ExprErrorCode::WrongArity:
      return Code::UnknownFunction;
    case ExprErrorCode::DimensionMismatch:
    case ExprErrorCode::NotANumber:
    case ExprErrorCode::NotAQuantity:
    case ExprErrorCode::NotATruthValue:
    case ExprErrorCode::BadPower:
      return Code::DimensionMismatch;
    case ExprErrorCode::NotFinite:
      return Code::NotFinite;
    case ExprErrorCode::NotConstant:
      return Code::NotConstant;
    case ExprErrorCode::Syntax:
    case ExprErrorCode::BadNumber:
    case ExprErrorCode::TooComplex:
      break;
  }
  return Code::BadExpression;
}

/// Names that differ from neuron to neuron, so that their use in a constant can be called what it is.
const Environment& varying_names() {
  static const Environment kNames = [] {
    Environment names;
    std::uint32_t slot = 0;
    for (const char* name : {"index", "pos", "size", "random", "pre.index", "post.index", "pre.size", "post.size",
                             "pre.pos", "post.pos"}) {
      names.add_variable(name, kNumber, slot++);
    }
    for (const char* name : {"x", "y", "ecc", "pre.x", "pre.y", "pre.ecc", "post.x", "post.y", "distance"}) {
      names.add_variable(name, kAngle, slot++);
    }
    names.add_variable("side", kWord, slot++);
    names.add_variable("hemifield", kWord, slot++);
    return names;
  }();
  return kNames;
}

/// What only the two ends of a projection, or the columns of its edge list, give a meaning.
bool is_pair_name(std::string_view name) {
  for (const char* whole : {"x", "y", "ecc", "distance", "side", "hemifield"}) {
    if (name == whole) {
      return true;
    }
  }
  const std::string_view prefix = name.substr(0, name.find('.'));
  return prefix != name &&
         (prefix == "pre" || prefix == "post" || prefix == "edge" || prefix == "side" || prefix == "hemifield");
}

}  // namespace

Span span_in_file(const ValueDecl& value, ExprSpan span) {
  if (!value.has_exact_offsets || value.is_number) {
    return value.span;
  }
  return {value.span.file, value.span.begin + span.begin, value.span.begin + span.end};
}

std::string shown(double coherent, const Dimension& dimension) { return format_quantity({coherent, dimension}); }

std::optional<std::uint64_t> whole_ticks(double time_ms, std::uint64_t tick_ns) {
  const double ticks = time_ms * 1e6 / static_cast<double>(tick_ns);
  const double nearest = std::round(ticks);
  if (!(ticks >= 0) || nearest > 9e15 || std::abs(ticks - nearest) > 1e-6 * std::max(1.0, nearest * 1e-6)) {
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(nearest);
}

void Scope::report(const ValueDecl& value, const std::vector<ExprError>& errors) {
  for (const ExprError& error : errors) {
    if (error.code == ExprErrorCode::UnknownName) {
      const std::string name = value.text.substr(error.span.begin, error.span.end - error.span.begin);
      if (broken.count(name) != 0 || !knows_all_names || (!knows_pair_names && is_pair_name(name))) {
        keep_silent();
        continue;
      }
      if (const auto why = absent.find(name); why != absent.end()) {
        diagnostics_.add(Code::NoGeometry, span_in_file(value, error.span), {why->second});
        continue;
      }
    }
    auto builder = diagnostics_.add(code_of(error.code), span_in_file(value, error.span), {error.message});
    if (error.other) {
      builder.label(span_in_file(value, *error.other), error.other_label);
    }
    if (!error.help.empty()) {
      builder.help(error.help);
    }
  }
}

std::optional<TypedExpression> Scope::expression(const ValueDecl& value, const Environment& names) {
  if (value.is_poisoned) {
    keep_silent();
    return std::nullopt;
  }
  std::vector<ExprError> errors;
  std::optional<TypedExpression> typed;
  if (const auto parsed = parse_expression(value.text, errors)) {
    if (value.scope == 0) {
      typed = type_expression(*parsed, names, errors);
    } else {
      Environment scoped = names;
      scoped.outer = &instances[value.scope];
      typed = type_expression(*parsed, scoped, errors);
    }
  }
  report(value, errors);
  return typed;
}

void Scope::report_dimension(const ValueDecl& value, std::string_view key, const Dimension& wanted,
                             const Dimension& found) {
  if (found.is_number()) {
    const std::string unit = display_unit(wanted);
    diagnostics_.add(Code::MissingUnit, value.span, {std::string(key), describe(wanted)})
        .help(fmt::format("write \"{} {}\", with the unit that is meant", value.text, unit));
    return;
  }
  diagnostics_.add(Code::WrongDimension, value.span, {std::string(key), describe(wanted), describe(found)});
}

std::optional<TypedExpression> Scope::expression(const ValueDecl& value, const Environment& names, std::string_view key,
                                                 const Dimension& wanted) {
  auto typed = expression(value, names);
  if (typed && typed->dimension != wanted) {
    report_dimension(value, key, wanted, typed->dimension);
    return std::nullopt;
  }
  return typed;
}

std::optional<Quantity> Scope::quantity(const ValueDecl& value) {
  if (value.is_poisoned) {
    keep_silent();
    return std::nullopt;
  }
  std::vector<ExprError> errors;
  Environment names = varying_names();
  names.outer = value.scope == 0 ? &environment : &instances[value.scope];
  const auto result = evaluate_constant(value.text, names, errors);
  report(value, errors);
  return result;
}

std::optional<double> Scope::constant(const ValueDecl& value, std::string_view key, const Dimension& wanted) {
  const auto result = quantity(value);
  if (!result) {
    return std::nullopt;
  }
  if (result->dimension != wanted) {
    report_dimension(value, key, wanted, result->dimension);
    return std::nullopt;
  }
  return result->value;
}

std::optional<std::uint64_t> Scope::whole(const ValueDecl& value, std::string_view key, std::uint64_t lowest,
                                          std::uint64_t highest) {
  const auto number = constant(value, key, kNumber);
  if (!number) {
    return std::nullopt;
  }
  if (*number != std::floor(*number)) {
    diagnostics_.add(Code::NotWhole, value.span, {std::string(key), shown(*number, kNumber)});
    return std::nullopt;
  }
  if (*number < static_cast<double>(lowest) || *number > static_cast<double>(highest)) {
    diagnostics_.add(Code::OutOfRange, value.span,
                     {std::string(key), shown(*number, kNumber), fmt::format("{} to {}", lowest, highest)});
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(*number);
}

std::optional<std::uint64_t> Scope::ticks(const ValueDecl& value, std::string_view key, std::uint64_t tick_ns) {
  const auto time_ms = constant(value, key, kTime);
  if (!time_ms) {
    return std::nullopt;
  }
  if (*time_ms < 0) {
    diagnostics_.add(Code::OutOfRange, value.span, {std::string(key), shown(*time_ms, kTime), "0 ms or more"});
    return std::nullopt;
  }
  if (!knows_tick) {
    keep_silent();
    return std::nullopt;
  }
  const auto ticks = whole_ticks(*time_ms, tick_ns);
  if (!ticks) {
    const double tick_ms = static_cast<double>(tick_ns) / 1e6;
    const double below_ms = std::floor(*time_ms / tick_ms) * tick_ms;
    diagnostics_.add(Code::TimeNotTicks, value.span, {std::string(key), shown(*time_ms, kTime), shown(tick_ms, kTime)})
        .help(fmt::format("the nearest are {:g} ms and {:g} ms", below_ms, below_ms + tick_ms));
  }
  return ticks;
}

}  // namespace tectum
