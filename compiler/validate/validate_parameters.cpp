// The circuit's own parameters: each may use others, in any order.
#include <algorithm>

#include "compiler/validate/validation.h"

namespace tectum {
namespace {

enum class Progress : std::uint8_t { Waiting, Open, Done };

class ParameterOrder {
 public:
  explicit ParameterOrder(Validation& v) : v_(v), progress_(v.decl.parameters.size(), Progress::Waiting) {
    for (const ParameterDecl& parameter : v.decl.parameters) {
      values_.push_back(&parameter.value);
    }
    apply_overrides();
  }

  void run() {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      resolve(i);
    }
  }

 private:
  std::optional<std::size_t> find(std::string_view name) const {
    for (std::size_t i = 0; i < v_.decl.parameters.size(); ++i) {
      if (v_.decl.parameters[i].name.text == name) {
        return i;
      }
    }
    return std::nullopt;
  }

  void apply_overrides() {
    for (const ParameterDecl& parameter : v_.overrides.parameters) {
      if (const auto i = find(parameter.name.text)) {
        values_[*i] = &parameter.value;
      } else {
        v_.diagnostics()
            .add(Code::UnknownOverride, parameter.name.span, {parameter.name.text})
            .help_if(nearest_name(parameter.name.text, names_of(v_.decl.parameters)), "did you mean `{}`?");
      }
    }
  }

  void resolve(std::size_t i) {
    const ParameterDecl& parameter = v_.decl.parameters[i];
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
    if (const auto parsed = parse_expression(values_[i]->text, ignored)) {
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
    v_.scope.environment.add_constant(parameter.name.text, *quantity);
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
  std::vector<Progress> progress_;
  std::vector<const ValueDecl*> values_;
};

/// Names that expressions use for something else.
bool is_reserved(const Validation& v, const std::string& name) {
  static const std::vector<std::string> kReserved = {"pre",   "post", "ecc", "x",        "y",  "side", "hemifield",
                                                     "index", "size", "pos", "distance", "pi", "true", "false"};
  return std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end() || v.circuit.words.count(name) != 0;
}

}  // namespace

void validate_parameters(Validation& v) {
  for (const ParameterDecl& parameter : v.decl.parameters) {
    if (is_reserved(v, parameter.name.text)) {
      v.diagnostics()
          .add(Code::BadName, parameter.name.span, {parameter.name.text})
          .help("it has a meaning of its own in expressions");
    }
  }
  ParameterOrder(v).run();
}

}  // namespace tectum
