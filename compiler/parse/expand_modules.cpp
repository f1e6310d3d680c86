#include "compiler/parse/expand_modules.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "compiler/expression/expression.h"

namespace tectum {
namespace {

template <typename Decls>
std::vector<std::string> declared_names(const Decls& decls) {
  std::vector<std::string> names;
  for (const auto& decl : decls) {
    names.push_back(decl.name.text);
  }
  return names;
}

std::vector<std::string> texts(const std::vector<NameDecl>& names) {
  std::vector<std::string> result;
  for (const NameDecl& name : names) {
    result.push_back(name.text);
  }
  return result;
}

class Expansion {
 public:
  Expansion(CircuitDecl& decl, const ModuleDecl& module, const InstanceDecl& instance, Diagnostics& diagnostics)
      : decl_(decl), module_(module), instance_(instance), diagnostics_(diagnostics) {
    for (const NeuronDecl& neuron : module.neurons) {
      neurons_.insert(neuron.name.text);
    }
    for (const PopulationDecl& population : module.populations) {
      populations_.insert(population.name.text);
    }
  }

  void run() {
    scope_ = static_cast<std::uint32_t>(decl_.scopes.size());
    decl_.scopes.push_back({instance_.name.text, parameters()});
    check_ports();
    for (NeuronDecl neuron : module_.neurons) {
      add(std::move(neuron));
    }
    for (PopulationDecl population : module_.populations) {
      add(std::move(population));
    }
    for (ProjectionDecl projection : module_.projections) {
      add(std::move(projection));
    }
  }

 private:
  /// The module's parameters, with the instance's values in their place. Those are the circuit's to understand.
  std::vector<ParameterDecl> parameters() {
    std::vector<ParameterDecl> result = module_.parameters;
    for (ParameterDecl& parameter : result) {
      parameter.value.scope = scope_;
      for (ValueDecl& bound : parameter.range) {
        bound.scope = scope_;
      }
    }
    for (const KeyedValue& given : instance_.parameters) {
      const auto same = std::find_if(result.begin(), result.end(),
                                     [&](const ParameterDecl& p) { return p.name.text == given.key.text; });
      if (same == result.end() || given.values.size() != 1) {
        diagnostics_.add(Code::UnknownParameter, given.key.span, {"module", module_.name.text, given.key.text})
            .help_if(nearest_name(given.key.text, declared_names(module_.parameters)), "did you mean `{}`?");
      } else {
        same->value = given.values.front();
      }
    }
    return result;
  }

  void check_ports() {
    const std::vector<std::string> ports = texts(module_.ports);
    for (const PortBinding& binding : instance_.ports) {
      if (std::find(ports.begin(), ports.end(), binding.port.text) == ports.end()) {
        diagnostics_.add(Code::UnknownPort, binding.port.span, {module_.name.text, binding.port.text})
            .help_if(nearest_name(binding.port.text, ports), "did you mean `{}`?");
      }
    }
    for (const NameDecl& port : module_.ports) {
      if (port.is_poisoned || instance_.has_poisoned_ports) {
        continue;
      }
      if (find_binding(port.text) == nullptr) {
        diagnostics_.add(Code::UnboundPort, instance_.name.span, {instance_.name.text, port.text})
            .label(port.span, "the port")
            .help(fmt::format("\"ports\": {{ \"{}\": \"a population\" }}", port.text));
      }
    }
  }

  const PortBinding* find_binding(const std::string& port) const {
    for (const PortBinding& binding : instance_.ports) {
      if (binding.port.text == port) {
        return &binding;
      }
    }
    return nullptr;
  }

  void localise(NameDecl& name) const { name.text = instance_.name.text + "." + name.text; }
  void localise(ValueDecl& value) const { value.scope = scope_; }
  void localise(std::optional<ValueDecl>& value) const {
    if (value) {
      localise(*value);
    }
  }
  void localise(std::vector<KeyedValue>& values) const {
    for (KeyedValue& keyed : values) {
      for (ValueDecl& value : keyed.values) {
        localise(value);
      }
    }
  }
  void localise(std::vector<ExceptionDecl>& exceptions) const {
    for (ExceptionDecl& exception : exceptions) {
      localise(exception.values);
    }
  }

  void add(NeuronDecl neuron) {
    localise(neuron.name);
    if (neuron.extends && neurons_.count(neuron.extends->text) != 0) {
      localise(*neuron.extends);
    }
    localise(neuron.parameters);
    for (ReceptorDecl& receptor : neuron.receptors) {
      localise(receptor.tau);
      localise(receptor.window);
    }
    decl_.neurons.push_back(std::move(neuron));
  }

  void add(PopulationDecl population) {
    localise(population.name);
    if (population.neuron && neurons_.count(population.neuron->text) != 0) {
      localise(*population.neuron);
    }
    localise(population.size);
    localise(population.position);
    localise(population.overrides);
    localise(population.exceptions);
    decl_.populations.push_back(std::move(population));
  }

  void add(ProjectionDecl projection) {
    localise(projection.name);
    projection.from = endpoints(projection.from);
    projection.to = endpoints(projection.to);
    localise(projection.rule.arguments);
    localise(projection.weight);
    localise(projection.delay);
    localise(projection.where);
    localise(projection.exceptions);
    if (projection.plasticity) {
      localise(projection.plasticity->numbers);
      localise(projection.plasticity->learned);
      for (ValueDecl& bound : projection.plasticity->bounds) {
        localise(bound);
      }
    }
    decl_.projections.push_back(std::move(projection));
  }

  /// "EBN.left" of a local population, "drive.left" of a port, or a name of the circuit.
  std::vector<NameDecl> endpoints(const std::vector<NameDecl>& names) const {
    std::vector<NameDecl> result;
    const std::vector<std::string> ports = texts(module_.ports);
    for (const NameDecl& name : names) {
      const std::size_t dot = std::min(name.text.find('.'), name.text.size());
      const std::string base = name.text.substr(0, dot);
      if (populations_.count(base) != 0) {
        result.push_back(name);
        localise(result.back());
      } else if (const PortBinding* binding = find_binding(base)) {
        for (const NameDecl& bound : binding->populations) {
          result.push_back({bound.text + name.text.substr(dot), bound.span, bound.is_poisoned});
        }
      } else if (std::find(ports.begin(), ports.end(), base) != ports.end()) {
        result.push_back({name.text, name.span, true});  // the port is bound to nothing, which has been reported
      } else {
        result.push_back(name);
      }
    }
    return result;
  }

  CircuitDecl& decl_;
  const ModuleDecl& module_;
  const InstanceDecl& instance_;
  Diagnostics& diagnostics_;
  std::set<std::string> neurons_;
  std::set<std::string> populations_;
  std::uint32_t scope_ = 0;
};

}  // namespace

void expand_modules(CircuitDecl& decl, Diagnostics& diagnostics) {
  decl.scopes.assign(1, {});
  for (const InstanceDecl& instance : decl.instances) {
    const auto module = std::find_if(decl.modules.begin(), decl.modules.end(),
                                     [&](const ModuleDecl& m) { return m.name.text == instance.module.text; });
    if (instance.module.is_poisoned || module == decl.modules.end() || module->is_poisoned) {
      decl.poisoned_instances.insert(instance.name.text);
    }
    if (instance.module.is_poisoned || (module == decl.modules.end() && decl.poisoned_sections.count("modules") != 0)) {
      continue;
    }
    if (module == decl.modules.end()) {
      diagnostics.add(Code::UnknownModule, instance.module.span, {instance.module.text})
          .help_if(nearest_name(instance.module.text, declared_names(decl.modules)), "did you mean `{}`?");
      continue;
    }
    Expansion(decl, *module, instance, diagnostics).run();
  }
}

}  // namespace tectum
