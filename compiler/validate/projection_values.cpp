// The expressions: weight, delay, where, and what differs by side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compiler/validate/projection_validator.h"

namespace tectum {

Unit ProjectionValidator::weight_unit(const Endpoint& to) const {
  const Population& target = population(to);
  if (target.user_model) {
    return {target.user_model->equations.inputs[to.receptor].dimension, 0, 1};
  }
  return parse_unit(find_model(target.model)->weight_unit).value_or(Unit{});
}

void ProjectionValidator::weight() {
  if (!decl_.weight || !is_sound_) {
    return;
  }
  made_.weight_span = decl_.weight->span;
  const Unit unit = weight_unit(made_.to.front());
  for (std::size_t i = 1; i < made_.to.size(); ++i) {
    if (weight_unit(made_.to[i]).dimension != unit.dimension) {
      v_.diagnostics()
          .add(Code::MixedUnits, decl_.to[i].span, {decl_.to.front().text, decl_.to[i].text})
          .help("write one projection for each");
      return;
    }
  }
  if (auto typed = weight_of(*decl_.weight, unit)) {
    made_.weight = std::move(*typed);
  }
  exceptions(unit);
}

std::optional<TypedExpression> ProjectionValidator::weight_of(const ValueDecl& value, const Unit& unit) {
  auto typed = v_.scope.expression(value, names_, "weight", unit.dimension);
  if (typed && typed->constant && *typed->constant < 0) {
    v_.diagnostics()
        .add(Code::NegativeWeight, value.span, {shown(*typed->constant, unit.dimension)})
        .help("write `\"sign\": \"inhibitory\"` and the weight without its minus");
  }
  return typed;
}

void ProjectionValidator::exceptions(const Unit& unit) {
  for (const ExceptionDecl& decl : decl_.exceptions) {
    const std::vector<std::string> known = known_sides();
    if (std::find(known.begin(), known.end(), decl.side.text) == known.end()) {
      v_.diagnostics()
          .add(Code::UnknownSide, decl.side.span, {decl_.to.front().text, decl.side.text})
          .help_if(nearest_name(decl.side.text, known), "did you mean `{}`?");
    }
    SideException exception;
    exception.side = decl.side.text;
    for (const KeyedValue& keyed : decl.values) {
      if (keyed.key.text == "weight" && keyed.values.size() == 1) {
        exception.weight = weight_of(keyed.values.front(), unit);
      } else if (keyed.key.text == "delay" && keyed.values.size() == 1) {
        exception.delay = delay_of(keyed.values.front());
      } else {
        v_.diagnostics()
            .add(Code::UnknownKey, keyed.key.span, {keyed.key.text, fmt::format("exception `{}`", decl.side.text)})
            .help("an exception gives `weight` or `delay`");
      }
    }
    made_.exceptions.push_back(std::move(exception));
  }
}

void ProjectionValidator::delay() {
  if (!decl_.delay) {
    return;
  }
  made_.delay_span = decl_.delay->span;
  if (auto typed = delay_of(*decl_.delay)) {
    made_.delay = std::move(*typed);
  }
}

std::optional<TypedExpression> ProjectionValidator::delay_of(const ValueDecl& value) {
  auto typed = v_.scope.expression(value, names_, "delay", kTime);
  if (!typed || !typed->constant) {
    return typed;
  }
  const double delay_ms = *typed->constant;
  const auto ticks = whole_ticks(delay_ms, v_.circuit.tick_ns);
  if (delay_ms >= 0 && !v_.scope.knows_tick) {
    return typed;
  }
  if (delay_ms < 0) {
    v_.diagnostics().add(Code::OutOfRange, value.span, {"delay", shown(delay_ms, kTime), "0 ms or more"});
  } else if (!ticks) {
    const double tick_ms = v_.circuit.tick_ms();
    const double below = std::floor(delay_ms / tick_ms) * tick_ms;
    v_.diagnostics()
        .add(Code::DelayNotTicks, value.span, {shown(delay_ms, kTime), shown(tick_ms, kTime)})
        .help(fmt::format("the nearest are {:g} ms and {:g} ms", below, below + tick_ms));
  } else if (*ticks > kMaxDelayTicks) {
    v_.diagnostics().add(Code::DelayTooLong, value.span, {shown(delay_ms, kTime), fmt::format("{}", kMaxDelayTicks)});
  }
  return typed;
}

void ProjectionValidator::where() {
  if (!decl_.where) {
    return;
  }
  auto typed = v_.scope.expression(*decl_.where, names_);
  if (typed && typed->dimension != kBoolean) {
    v_.diagnostics()
        .add(Code::NotATruthValue, decl_.where->span, {describe(typed->dimension)})
        .help("compare: \"ecc > 20 deg\", \"hemifield == side\"");
  } else if (typed) {
    made_.where = std::move(typed);
  }
}

void ProjectionValidator::values_alone() {
  if (names_.outer == nullptr) {
    names_.outer = &v_.scope.environment;
  }
  v_.scope.knows_pair_names = false;
  if (decl_.weight) {
    static_cast<void>(v_.scope.expression(*decl_.weight, names_));
  }
  delay();
  v_.scope.knows_pair_names = true;
  v_.scope.absent.clear();
}

}  // namespace tectum
