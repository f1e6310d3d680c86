// The circuit's own parameters: each may use others, in any order.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "compiler/validate/validation.h"

namespace tectum {
namespace {

enum class Progress : std::uint8_t { Waiting, Open, Done };

/// Evaluates a list of parameters into the names of their scope.
class ParameterOrder {
 public:
  ParameterOrder(Validation& v, const ScopeDecl& scope, std::uint32_t number, Environment& names)
      : v_(v),
        parameters_(scope.parameters),
        scope_(number),
        names_(names),
        progress_(scope.parameters.size(), Progress::Waiting) {
    const std::string prefix = scope.prefix.empty() ? "" : scope.prefix + ".";
    for (const ParameterDecl& parameter : scope.parameters) {
      values_.push_back(&parameter.value);
      for (const ParameterDecl& given : v.overrides.parameters) {
        if (given.name.text == prefix + parameter.name.text) {
          values_.back() = &given.value;
        }
      }
    }
  }

  void run() {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      resolve(i);
    }
  }

 private:
  std::optional<std::size_t> find(std::string_view name) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (parameters_[i].name.text == name) {
        return i;
      }
    }
    return std::nullopt;
  }

  void resolve(std::size_t i) {
    const ParameterDecl& parameter = parameters_[i];
    if (progress_[i] == Progress::Done) {
      return;
    }
    if (progress_[i] == Progress::Open) {
      if (v_.scope.broken.insert(parameter.name.text).second) {
        v_.diagnostics().add(Code::ParameterCycle, parameter.name.span, {parameter.name.text});
      }
      return;
    }
    progress_[i] = Progress::Open;
    std::vector<ExprError> ignored;  // reported when the value is evaluated
    // What an instance gives for a module's parameter is written outside the module and sees none of its names.
    const bool sees_siblings = values_[i]->scope == scope_;
    const auto parsed = parse_expression(values_[i]->text, ignored);
    if (parsed && sees_siblings) {
      for (const NameUse& use : names_in(*parsed)) {
        if (const auto other = find(use.name)) {
          resolve(*other);
        }
      }
    }
    progress_[i] = Progress::Done;
    evaluate(parameter, *values_[i]);
  }

  void evaluate(const ParameterDecl& parameter, const ValueDecl& value) {
    const auto quantity = v_.scope.quantity(value);
    if (!quantity || v_.scope.broken.count(parameter.name.text) != 0) {
      v_.scope.broken.insert(parameter.name.text);
      return;
    }
    names_.add_constant(parameter.name.text, *quantity);
    if (parameter.range.size() == 2) {
      check_range(parameter, value, *quantity);
    }
  }

  void check_range(const ParameterDecl& parameter, const ValueDecl& value, const Quantity& quantity) {
    const std::string what = "range";
    const auto lowest = v_.scope.constant(parameter.range[0], what, quantity.dimension);
    const auto highest = v_.scope.constant(parameter.range[1], what, quantity.dimension);
    if (!lowest || !highest) {
      return;
    }
    const std::string low = shown(*lowest, quantity.dimension);
    const std::string high = shown(*highest, quantity.dimension);
    if (*lowest > *highest) {
      v_.diagnostics().add(Code::RangeReversed, parameter.range[0].span, {"`range`", low, high});
    } else if (quantity.value < *lowest || quantity.value > *highest) {
      v_.diagnostics().add(Code::OutOfRange, value.span,
                           {parameter.name.text, format_quantity(quantity), low + " to " + high});
    }
  }

  Validation& v_;
  const std::vector<ParameterDecl>& parameters_;
  std::uint32_t scope_;
  Environment& names_;
  std::vector<Progress> progress_;
  std::vector<const ValueDecl*> values_;
};

/// Names that expressions use for something else.
bool is_reserved(const Validation& v, const std::string& name) {
  static const std::vector<std::string> kReserved = {"pre",    "post",      "ecc",   "x",    "y",
                                                     "side",   "hemifield", "index", "size", "pos",
                                                     "random", "distance",  "pi",    "true", "false"};
  return std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end() || v.circuit.words.count(name) != 0;
}

std::string help_on_override(const std::string& given, const std::vector<std::string>& names) {
  if (names.empty()) {
    return "the circuit has no `parameters`";
  }
  const std::optional<std::string> nearest = nearest_name(given, names);
  return nearest ? fmt::format("did you mean `{}`?", *nearest)
                 : fmt::format("the circuit's parameters: {}", fmt::join(names, ", "));
}

void report_unknown_overrides(Validation& v) {
  std::vector<std::string> names = names_of(v.decl.parameters);
  for (const ScopeDecl& scope : v.decl.scopes) {
    for (const ParameterDecl& parameter : scope.parameters) {
      names.push_back(scope.prefix + "." + parameter.name.text);
    }
  }
  for (const ParameterDecl& given : v.overrides.parameters) {
    if (std::find(names.begin(), names.end(), given.name.text) == names.end()) {
      v.diagnostics()
          .add(Code::UnknownOverride, given.name.span, {given.name.text})
          .help(help_on_override(given.name.text, names));
    }
  }
}

void check_source(Validation& v, const ParameterDecl& parameter) {
  v.check_cites(parameter.provenance);
  if (!parameter.basis || parameter.basis->is_poisoned) {
    return;
  }
  const std::vector<std::string> bases = {"fitted", "derived", "chosen"};
  if (std::find(bases.begin(), bases.end(), parameter.basis->text) == bases.end()) {
    v.diagnostics()
        .add(Code::UnknownWord, parameter.basis->span, {"basis", parameter.basis->text})
        .help("a value that no source gives is `fitted`, `derived` from other numbers, or `chosen`");
  }
}

}  // namespace

void validate_parameters(Validation& v) {
  const auto check_names = [&](const std::vector<ParameterDecl>& parameters) {
    for (const ParameterDecl& parameter : parameters) {
      check_source(v, parameter);
      if (is_reserved(v, parameter.name.text)) {
        v.diagnostics()
            .add(Code::BadName, parameter.name.span, {parameter.name.text})
            .help("it has a meaning of its own in expressions");
      }
    }
  };
  report_unknown_overrides(v);
  check_names(v.decl.parameters);
  const ScopeDecl circuit{"", v.decl.parameters};
  ParameterOrder(v, circuit, 0, v.scope.environment).run();
  v.scope.instances.resize(v.decl.scopes.size());
  for (std::uint32_t i = 1; i < v.decl.scopes.size(); ++i) {
    v.scope.instances[i].outer = &v.scope.environment;
    check_names(v.decl.scopes[i].parameters);
    ParameterOrder(v, v.decl.scopes[i], i, v.scope.instances[i]).run();
  }
}

}  // namespace tectum
