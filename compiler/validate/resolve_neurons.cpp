#include "compiler/validate/resolve_neurons.h"
#include "compiler/diagnostics/counted.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace tectum {
namespace {

constexpr double kDefaultSynapticTauMs = 2;  // AMPA-like decay

enum class Progress : std::uint8_t { Waiting, Open, Done };

class NeuronOrder {
 public:
  explicit NeuronOrder(Validation& v)
      : v_(v), progress_(v.decl.neurons.size(), Progress::Waiting), resolved_(v.decl.neurons.size()) {}

  std::vector<std::optional<ResolvedNeuron>> run() {
    for (std::size_t i = 0; i < progress_.size(); ++i) {
      resolve(i);
    }
    return std::move(resolved_);
  }

 private:
  void resolve(std::size_t i) {
    const NeuronDecl& decl = v_.decl.neurons[i];
    if (progress_[i] != Progress::Waiting) {
      return;
    }
    progress_[i] = Progress::Open;
    v_.check_cites(decl.provenance);
    ResolvedNeuron neuron;
    bool is_sound = true;
    if (decl.extends) {
      if (const auto base = find(decl, *decl.extends)) {
        neuron = *base;
      } else {
        is_sound = false;
      }
    }
    neuron.name = decl.name;
    if (decl.model) {
      neuron.model_name = *decl.model;
      neuron.model = find_model(decl.model->text);
      neuron.user_model = nullptr;
      if (const auto user = v_.user_models.find(decl.model->text); user != v_.user_models.end()) {
        neuron.user_model = user->second;
        neuron.model = user->second ? &user->second->info : nullptr;
        is_sound = is_sound && user->second;  // a wrong one has been reported
      }
      const bool is_declared = v_.user_models.count(decl.model->text) != 0;
      if (!is_declared && (neuron.model == nullptr || neuron.model->kind == ModelKind::FieldSource)) {
        if (v_.can_report(*decl.model, "models")) {
          report_model(*decl.model);
        }
        is_sound = false;
      }
    }
    merge(neuron.parameters, decl.parameters);
    merge_receptors(neuron.receptors, decl.receptors);
    neuron.has_poisoned_receptors = neuron.has_poisoned_receptors || decl.has_poisoned_receptors;
    progress_[i] = Progress::Done;
    if (is_sound && neuron.model != nullptr) {
      resolved_[i] = std::move(neuron);
    }
  }

  const ResolvedNeuron* find(const NeuronDecl& decl, const NameDecl& base) {
    for (std::size_t i = 0; i < v_.decl.neurons.size(); ++i) {
      if (v_.decl.neurons[i].name.text != base.text) {
        continue;
      }
      if (progress_[i] == Progress::Open) {
        v_.diagnostics().add(Code::ExtendsCycle, base.span, {decl.name.text});
        return nullptr;
      }
      resolve(i);
      return resolved_[i] ? &*resolved_[i] : nullptr;
    }
    if (v_.can_report(base, "neurons")) {
      v_.diagnostics()
          .add(Code::UnknownNeuron, base.span, {base.text})
          .help_if(nearest_name(base.text, names_of(v_.decl.neurons)), "did you mean `{}`?");
    }
    return nullptr;
  }

  void report_model(const NameDecl& model) {
    std::vector<std::string> names;
    std::string list;
    for (const ModelInfo& info : all_models()) {
      if (info.kind != ModelKind::FieldSource) {
        names.emplace_back(info.name);
        list += fmt::format("{}{}", list.empty() ? "" : ", ", info.name);
      }
    }
    for (const auto& [name, user] : v_.user_models) {
      names.push_back(name);
      list += ", " + name;
    }
    const auto nearest = nearest_name(model.text, names);
    auto builder = v_.diagnostics().add(Code::UnknownModel, model.span, {model.text});
    if (nearest) {
      builder.help_if(nearest, "did you mean `{}`?");
    } else {
      builder.help("the models are " + list);
    }
  }

  static void merge(std::vector<KeyedValue>& base, const std::vector<KeyedValue>& over) {
    for (const KeyedValue& value : over) {
      const auto same =
          std::find_if(base.begin(), base.end(), [&](const auto& b) { return b.key.text == value.key.text; });
      if (same == base.end()) {
        base.push_back(value);
      } else {
        *same = value;
      }
    }
  }

  static void merge_receptors(std::vector<ReceptorDecl>& base, const std::vector<ReceptorDecl>& over) {
    for (const ReceptorDecl& receptor : over) {
      const auto same =
          std::find_if(base.begin(), base.end(), [&](const auto& b) { return b.name.text == receptor.name.text; });
      if (same == base.end()) {
        base.push_back(receptor);
      } else {
        *same = receptor;
      }
    }
  }

  Validation& v_;
  std::vector<Progress> progress_;
  std::vector<std::optional<ResolvedNeuron>> resolved_;
};

bool takes(const ModelInfo& model, ReceptorKind kind) {
  return ((model.receptor_kinds >> static_cast<std::uint32_t>(kind)) & 1U) != 0;
}

constexpr std::array kKinds = {ReceptorKind::Instantaneous, ReceptorKind::Exponential, ReceptorKind::Boxcar};

ReceptorKind usual_kind(const ModelInfo& model) {
  return takes(model, ReceptorKind::Instantaneous) ? ReceptorKind::Instantaneous : ReceptorKind::Exponential;
}

std::optional<ReceptorKind> kind_of(Validation& v, const ReceptorDecl& decl, const ModelInfo& model) {
  if (!decl.kind) {
    return decl.tau ? ReceptorKind::Exponential : decl.window ? ReceptorKind::Boxcar : usual_kind(model);
  }
  for (const ReceptorKind kind : kKinds) {
    if (decl.kind->text == receptor_kind_name(kind)) {
      return kind;
    }
  }
  if (decl.kind->is_poisoned) {
    return std::nullopt;
  }
  v.diagnostics()
      .add(Code::UnknownWord, decl.kind->span, {"receptor kind", decl.kind->text})
      .help("a receptor is `instantaneous`, `exponential` or `boxcar`");
  return std::nullopt;
}

double positive_tau(Validation& v, const ValueDecl& value, std::string_view key) {
  const auto tau_ms = v.scope.constant(value, key, kTime);
  if (tau_ms && !(*tau_ms > 0)) {
    v.diagnostics().add(Code::OutOfRange, value.span, {std::string(key), shown(*tau_ms, kTime), "above 0 ms"});
  }
  return tau_ms.value_or(1);
}

Receptor make_receptor(Validation& v, const ReceptorDecl& decl, const ResolvedNeuron& neuron) {
  Receptor receptor;
  receptor.name = decl.name.text;
  const auto kind = kind_of(v, decl, *neuron.model);
  if (!kind) {
    return receptor;
  }
  receptor.kind = *kind;
  if (!takes(*neuron.model, *kind)) {
    v.diagnostics().add(Code::ReceptorKindNotTaken, decl.kind ? decl.kind->span : decl.name.span,
                        {std::string(neuron.model->name), std::string(receptor_kind_name(*kind))});
    return receptor;
  }
  const std::string what = fmt::format("receptor `{}`", decl.name.text);
  if (*kind == ReceptorKind::Exponential) {
    if (decl.tau) {
      receptor.tau_ms = positive_tau(v, *decl.tau, "tau");
    } else {
      v.diagnostics().add(Code::MissingKey, decl.name.span, {what, "tau"});
    }
  } else if (*kind == ReceptorKind::Boxcar) {
    if (!decl.window) {
      v.diagnostics().add(Code::MissingKey, decl.name.span, {what, "window"});
    } else if (const auto ticks = v.scope.ticks(*decl.window, "window", v.circuit.tick_ns)) {
      if (*ticks < 1 || *ticks > kMaxWindowTicks) {
        v.diagnostics().add(Code::OutOfRange, decl.window->span,
                            {"window", fmt::format("{} ticks", *ticks), fmt::format("1 to {} ticks", kMaxWindowTicks)});
      }
      receptor.window_ticks = static_cast<std::uint32_t>(*ticks);
    }
  }
  return receptor;
}

/// tau_syn_ex and tau_syn_in stand for exponential receptors "ex" and "in".
void apply_shorthand(Validation& v, const ModelInfo& model, const char* key, const char* name,
                     std::vector<KeyedValue>& parameters, std::vector<Receptor>& receptors) {
  const auto found =
      std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return p.key.text == key; });
  if (found == parameters.end() || !takes(model, ReceptorKind::Exponential)) {
    return;  // an unknown parameter of this model, which is reported as such
  }
  const double tau_ms = found->values.size() == 1 ? positive_tau(v, found->values.front(), key) : 1.0;
  auto receptor = std::find_if(receptors.begin(), receptors.end(), [&](const auto& r) { return r.name == name; });
  if (receptor == receptors.end()) {
    receptor = receptors.insert(receptors.end(), Receptor{name, ReceptorKind::Exponential, tau_ms, 0});
  }
  receptor->kind = ReceptorKind::Exponential;
  receptor->tau_ms = tau_ms;
  parameters.erase(found);
}

/// A declared model has a receptor for each of its inputs; the neuron type says what they make of arrivals.
std::vector<Receptor> input_receptors(Validation& v, const ResolvedNeuron& neuron) {
  std::vector<Receptor> receptors;
  std::vector<std::string> names;
  for (const EquationInput& input : neuron.user_model->equations.inputs) {
    receptors.push_back({input.name, ReceptorKind::Instantaneous, 0, 0});
    names.push_back(input.name);
  }
  for (const ReceptorDecl& decl : neuron.receptors) {
    const auto found = std::find(names.begin(), names.end(), decl.name.text);
    if (found == names.end()) {
      v.diagnostics()
          .add(Code::UnknownReceptor, decl.name.span, {std::string(neuron.model->name), decl.name.text})
          .help(fmt::format("its inputs are {}", fmt::join(names, ", ")));
    } else {
      receptors[static_cast<std::size_t>(found - names.begin())] = make_receptor(v, decl, neuron);
    }
  }
  return receptors;
}

}  // namespace

std::vector<std::optional<ResolvedNeuron>> resolve_neurons(Validation& v) { return NeuronOrder(v).run(); }

std::vector<Receptor> resolve_receptors(Validation& v, const ResolvedNeuron& neuron,
                                        std::vector<KeyedValue>& parameters) {
  std::vector<Receptor> receptors;
  const ModelInfo& model = *neuron.model;
  if (model.max_receptors == 0) {
    if (!neuron.receptors.empty()) {
      v.diagnostics().add(Code::ReceptorKindNotTaken, neuron.receptors.front().name.span,
                          {std::string(model.name), "own"});
    }
    return receptors;
  }
  if (neuron.user_model) {
    return input_receptors(v, neuron);
  }
  for (const ReceptorDecl& decl : neuron.receptors) {
    receptors.push_back(make_receptor(v, decl, neuron));
  }
  const ReceptorKind usual = usual_kind(model);
  if (receptors.empty()) {
    for (const char* name : {"ex", "in"}) {
      receptors.push_back({name, usual, usual == ReceptorKind::Exponential ? kDefaultSynapticTauMs : 0, 0});
    }
  }
  apply_shorthand(v, model, "tau_syn_ex", "ex", parameters, receptors);
  apply_shorthand(v, model, "tau_syn_in", "in", parameters, receptors);
  if (receptors.size() > model.max_receptors) {
    v.diagnostics().add(Code::WrongCount, neuron.name.span,
                        {fmt::format("neuron type `{}`", neuron.name.text), counted(receptors.size(), "receptor"),
                         fmt::format("at most {}", model.max_receptors)});
  }
  return receptors;
}

}  // namespace tectum
