// Neuron models declared by equations: names resolved, dimensions checked term by term.
#include <fmt/format.h>

#include <limits>

#include "compiler/diagnostics/counted.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

class ModelValidator {
 public:
  ModelValidator(Validation& v, const ModelDecl& decl) : v_(v), decl_(decl) {}

  std::shared_ptr<const UserModel> run() {
    v_.check_cites(decl_.provenance);
    if (find_model(decl_.name.text) != nullptr) {
      v_.diagnostics().add(Code::NameClash, decl_.name.span, {decl_.name.text}).help("a built-in model has this name");
    }
    if (has_poison() || !fill_text()) {
      v_.scope.keep_silent();
      return nullptr;
    }
    const bool knows_method = method();
    std::vector<EquationError> errors;
    auto equations = check_equation_model(text_, v_.scope.environment, errors);
    for (const EquationError& error : errors) {
      report(error);
    }
    return equations && knows_method ? wrap(std::move(*equations)) : nullptr;
  }

 private:
  [[nodiscard]] bool has_poison() const {
    for (const auto* list : {&decl_.parameters, &decl_.inputs, &decl_.states, &decl_.equations, &decl_.reset}) {
      for (const NamedValueDecl& item : *list) {
        if (item.value.is_poisoned) {
          return true;
        }
      }
    }
    for (const NameDecl& state : decl_.hold.value_or(std::vector<NameDecl>{})) {
      if (state.is_poisoned) {
        return true;
      }
    }
    return decl_.threshold.is_poisoned || (decl_.refractory && decl_.refractory->is_poisoned) ||
           (decl_.method && decl_.method->is_poisoned);
  }

  bool fill_text() {
    copy(decl_.parameters, text_.parameters);
    copy(decl_.states, text_.states);
    copy(decl_.equations, text_.equations);
    copy(decl_.reset, text_.reset);
    text_.threshold = decl_.threshold.text;
    text_.refractory = decl_.refractory ? decl_.refractory->text : "";
    if (decl_.hold) {
      text_.hold.emplace();
      for (const NameDecl& state : *decl_.hold) {
        text_.hold->push_back(state.text);
      }
    }
    return inputs();
  }

  static void copy(const std::vector<NamedValueDecl>& from, std::vector<EquationText>& to) {
    for (const NamedValueDecl& item : from) {
      to.push_back({item.name.text, item.value.text});
    }
  }

  /// An input is given by the unit of what arrives at it.
  bool inputs() {
    bool is_sound = true;
    for (const NamedValueDecl& input : decl_.inputs) {
      const auto unit = parse_unit(input.value.text);
      if (!unit && input.value.text != "1") {
        v_.diagnostics()
            .add(Code::UnknownUnit, input.value.span, {fmt::format("unknown unit `{}`", input.value.text)})
            .help("an input has the unit of the weights that reach it: \"nA\", \"mV\", \"1\" for a plain number");
        is_sound = false;
      }
      text_.inputs.push_back({input.name.text, unit ? unit->dimension : kNumber});
    }
    if (text_.inputs.size() > kMaxReceptors) {
      v_.diagnostics().add(Code::WrongCount, decl_.name.span,
                           {fmt::format("model `{}`", decl_.name.text), counted(text_.inputs.size(), "input"),
                            fmt::format("at most {}", kMaxReceptors)});
      is_sound = false;
    }
    return is_sound;
  }

  bool method() {
    if (!decl_.method) {
      return true;
    }
    const std::string& name = decl_.method->text;
    if (name == "exact") {
      text_.method = EquationMethod::Exact;
    } else if (name == "euler") {
      text_.method = EquationMethod::Euler;
    } else if (name == "exponential_euler") {
      text_.method = EquationMethod::ExponentialEuler;
    } else {
      v_.diagnostics()
          .add(Code::UnknownWord, decl_.method->span, {"method", name})
          .help("a method is `exact`, `euler` or `exponential_euler`");
      text_.method = EquationMethod::Euler;  // takes every equation, so that only their own mistakes are reported
      return false;
    }
    return true;
  }

  /// The text that an error speaks of, as it stands in the file.
  [[nodiscard]] ValueDecl place(const EquationError& error) const {
    const auto of = [&](const std::vector<NamedValueDecl>& list) {
      if (!error.is_in_name) {
        return list[error.index].value;
      }
      ValueDecl name;
      name.text = list[error.index].name.text;
      name.span = list[error.index].name.span;
      name.has_exact_offsets = true;
      return name;
    };
    switch (error.part) {
      case EquationPart::Parameter:
        return of(decl_.parameters);
      case EquationPart::Input:
        return of(decl_.inputs);
      case EquationPart::State:
        return of(decl_.states);
      case EquationPart::Equation:
        return of(decl_.equations);
      case EquationPart::Reset:
        return of(decl_.reset);
      case EquationPart::Refractory:
        return *decl_.refractory;
      case EquationPart::Hold: {
        ValueDecl name;
        name.span = (*decl_.hold)[error.index].span;
        return name;
      }
      case EquationPart::Threshold:
        break;
    }
    return decl_.threshold;
  }

  void report(const EquationError& error) {
    if (error.code == EquationErrorCode::Expression) {
      v_.scope.report(place(error), {error.error});
      return;
    }
    auto builder =
        v_.diagnostics().add(Code::BadEquations, span_in_file(place(error), error.error.span), {error.error.message});
    if (!error.error.help.empty()) {
      builder.help(error.error.help);
    }
  }

  [[nodiscard]] std::shared_ptr<const UserModel> wrap(EquationModel equations) const {
    auto model = std::make_shared<UserModel>();
    model->name = decl_.name.text;
    model->equations = std::move(equations);
    for (const EquationModel::Parameter& parameter : model->equations.parameters) {
      ParameterInfo info{};
      info.name = parameter.name;
      info.may_vary = true;
      info.minimum = -std::numeric_limits<double>::infinity();
      info.minimum_is_allowed = true;
      info.maximum = std::numeric_limits<double>::infinity();
      model->parameters.push_back(info);
    }
    model->info.kind = ModelKind::Program;
    model->info.name = model->name;
    model->info.parameters = model->parameters;
    constexpr std::uint32_t kEveryKind = (1U << static_cast<std::uint32_t>(ReceptorKind::Instantaneous)) |
                                         (1U << static_cast<std::uint32_t>(ReceptorKind::Exponential)) |
                                         (1U << static_cast<std::uint32_t>(ReceptorKind::Boxcar));
    model->info.receptor_kinds = kEveryKind;
    model->info.max_receptors = static_cast<std::uint32_t>(model->equations.inputs.size());
    return model;
  }

  Validation& v_;
  const ModelDecl& decl_;
  EquationModelText text_;
};

}  // namespace

void validate_models(Validation& v) {
  for (const ModelDecl& decl : v.decl.models) {
    v.user_models[decl.name.text] = ModelValidator(v, decl).run();
  }
}

void check_user_model(Validation& v, const Population& population, const NameDecl& owner) {
  if (!v.scope.knows_tick) {
    return;
  }
  for (std::uint32_t i = 0; i < population.instance_count; ++i) {
    const Instance& instance = v.circuit.instances[index_of(population.first_instance) + i];
    const EquationParameterValues values(instance.parameters.begin(), instance.parameters.end());
    std::vector<EquationError> errors;
    if (!compile_equations(population.user_model->equations, values, population.size, v.circuit.tick_ms(), errors)) {
      for (const EquationError& error : errors) {
        v.diagnostics()
            .add(Code::BadEquations, owner.span, {error.error.message})
            .help(fmt::format("with the parameters that `{}` gives its model `{}`", instance.name,
                              population.user_model->name));
      }
      return;
    }
  }
}

}  // namespace tectum
