// Stimuli: a current from outside becomes a source of one spike a tick and a synapse on each neuron that it flows into.
//
// A membrane gets a receptor of its own for it, so fast that nothing is left of an arrival after one tick. With
// P = exp(-h / tau_m), a current I that is constant over a tick of length h moves the membrane by R_m I (1 - P); an
// arrival of w does by w B(h), B being the response to the receptor's exponential current (Rotter & Diesmann 1999,
// doi:10.1007/s004220050570). With w = R_m I (1 - P) / B(h) both are the same, exactly.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compiler/validate/validation.h"

namespace tectum {
namespace {

constexpr const char* kReceptorName = "stimulus";
// exp(-120) is 0 in a 32-bit float.
constexpr double kReceptorTausPerTick = 120;
constexpr std::uint64_t kMaxPulses = 100'000;
constexpr std::uint64_t kMaxStimulusTicks = 10'000'000;

/// The value of a parameter that is the same for all neurons of a side.
double shared_parameter(const Instance& instance, const ModelInfo& model, std::string_view name) {
  const auto given = instance.parameters.find(std::string(name));
  return given != instance.parameters.end() ? given->second.front()
                                            : model.parameters[find_parameter(model, name).value()].default_value;
}

class StimulusValidator {
 public:
  StimulusValidator(Validation& v, const StimulusDecl& decl) : v_(v), decl_(decl) {}

  void run() {
    const std::optional<std::vector<std::uint32_t>> ticks = spike_ticks();
    std::vector<Endpoint> targets;
    for (const NameDecl& name : decl_.into) {
      if (const auto target = v_.endpoint(name)) {
        targets.push_back(*target);
      }
    }
    if (!ticks || targets.size() != decl_.into.size() || v_.diagnostics().has_errors()) {
      return;
    }
    const auto source = add_source(*ticks);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      add_current(source, targets[k], decl_.into[k]);
    }
  }

 private:
  /// Arrivals in ticks [at, at + duration) of each pulse, over synapses of one tick.
  std::optional<std::vector<std::uint32_t>> spike_ticks() {
    const std::uint64_t tick_ns = v_.circuit.tick_ns;
    const auto at = v_.scope.ticks(decl_.at, "at", tick_ns);
    const auto duration = v_.scope.ticks(decl_.duration, "duration", tick_ns);
    const auto pulses = decl_.pulses ? v_.scope.whole(*decl_.pulses, "pulses", 1, kMaxPulses) : 1;
    const auto every = decl_.every ? v_.scope.ticks(*decl_.every, "every", tick_ns) : 0;
    if (!at || !duration || !pulses || !every) {
      return std::nullopt;
    }
    bool is_sound = in_range(*at, 1, kMaxStimulusTicks, decl_.at, "at");
    is_sound = in_range(*duration, 1, kMaxStimulusTicks / *pulses, decl_.duration, "duration") && is_sound;
    if (decl_.every) {
      is_sound = in_range(*every, *duration, kMaxStimulusTicks / *pulses, *decl_.every, "every") && is_sound;
    }
    if (!is_sound) {
      return std::nullopt;
    }
    std::vector<std::uint32_t> ticks;
    for (std::uint64_t pulse = 0; pulse < *pulses; ++pulse) {
      for (std::uint64_t k = 0; k < *duration; ++k) {
        ticks.push_back(static_cast<std::uint32_t>(*at - 1 + pulse * *every + k));
      }
    }
    return ticks;
  }

  bool in_range(std::uint64_t ticks, std::uint64_t low, std::uint64_t high, const ValueDecl& value, const char* key) {
    if (ticks >= low && ticks <= high) {
      return true;
    }
    const auto text = [&](std::uint64_t count) {
      return shown(static_cast<double>(count * v_.circuit.tick_ns) / 1e6, kTime);
    };
    v_.diagnostics().add(Code::OutOfRange, value.span,
                         {key, text(ticks), fmt::format("{} to {}", text(low), text(high))});
    return false;
  }

  PopulationId add_source(const std::vector<std::uint32_t>& ticks) {
    Population source;
    source.name = "stimuli." + decl_.name.text;
    source.name_span = decl_.name.span;
    source.model = ModelKind::SpikeList;
    source.size = 1;
    source.may_mix_signs = true;
    source.first_instance = static_cast<InstanceId>(v_.circuit.instances.size());
    const auto id = static_cast<PopulationId>(v_.circuit.populations.size());
    Instance instance;
    instance.name = source.name;
    instance.population = id;
    instance.spike_ticks = ticks;
    v_.circuit.instances.push_back(std::move(instance));
    v_.circuit.populations.push_back(std::move(source));
    return id;
  }

  void add_current(PopulationId source, const Endpoint& target, const NameDecl& name) {
    Population& population = v_.circuit.populations[index_of(target.population)];
    const ModelInfo& model = model_of(population);
    if (model.max_receptors == 0) {
      v_.diagnostics().add(Code::NoReceptor, name.span, {population.name, std::string(model.name)});
      return;
    }
    const std::optional<std::uint32_t> receptor = receptor_of(population, model, name);
    if (!receptor) {
      return;
    }
    const Dimension unit = population.user_model     ? population.user_model->equations.inputs[*receptor].dimension
                           : is_membrane(population) ? kCurrent
                                                     : parse_unit(model.weight_unit).value_or(Unit{}).dimension;
    const auto amplitude = v_.scope.constant(decl_.amplitude, "amplitude", unit);
    if (!amplitude) {
      return;
    }
    for (std::uint32_t i = 0; i < population.instance_count; ++i) {
      const Instance& instance = v_.circuit.instances[index_of(population.first_instance) + i];
      if (is_meant(target, instance)) {
        add_projection(source, target, instance, *receptor, arrival(population, model, instance, *amplitude));
      }
    }
  }

  static bool is_membrane(const Population& population) {
    return population.model == ModelKind::LifExp || population.model == ModelKind::Alif ||
           population.model == ModelKind::LifDelta;
  }

  static bool is_meant(const Endpoint& target, const Instance& instance) {
    for (std::size_t a = 0; a < target.fixed_sides.size(); ++a) {
      if (target.fixed_sides[a] && *target.fixed_sides[a] != instance.sides[a]) {
        return false;
      }
    }
    return true;
  }

  /// The stimulus' own receptor, or the one that a model by equations has for it.
  std::optional<std::uint32_t> receptor_of(Population& population, const ModelInfo& model, const NameDecl& name) {
    std::vector<std::string> names;
    for (const Receptor& receptor : population.receptors) {
      names.push_back(receptor.name);
    }
    const auto find = [&](const std::string& wanted) {
      return static_cast<std::uint32_t>(std::find(names.begin(), names.end(), wanted) - names.begin());
    };
    if (population.user_model) {
      const std::uint32_t found = find(decl_.receptor ? decl_.receptor->text : "ex");
      if (found < names.size() && population.receptors[found].kind == ReceptorKind::Instantaneous) {
        return found;
      }
      v_.diagnostics()
          .add(Code::UnknownReceptor, decl_.receptor ? decl_.receptor->span : name.span,
               {population.name, decl_.receptor ? decl_.receptor->text : "ex"})
          .help(
              "a stimulus of a model by equations goes into one of its instantaneous inputs; name it with `receptor`");
      return std::nullopt;
    }
    const std::uint32_t found = find(kReceptorName);
    if (found == names.size()) {
      if (names.size() >= model.max_receptors) {
        v_.diagnostics().add(Code::OutOfRange, name.span,
                             {"receptors", fmt::format("{}", names.size() + 1),
                              fmt::format("at most {}, and a stimulus takes one", model.max_receptors)});
        return std::nullopt;
      }
      const bool is_exponential = is_membrane(population) && population.model != ModelKind::LifDelta;
      population.receptors.push_back({kReceptorName,
                                      is_exponential ? ReceptorKind::Exponential : ReceptorKind::Instantaneous,
                                      is_exponential ? v_.circuit.tick_ms() / kReceptorTausPerTick : 0, 0});
    }
    return found;
  }

  /// What one spike must bring for the current of one tick.
  [[nodiscard]] double arrival(const Population& population, const ModelInfo& model, const Instance& instance,
                               double amplitude) const {
    if (!is_membrane(population)) {
      return amplitude;
    }
    const double tick_ms = v_.circuit.tick_ms();
    const double tau_m_ms = shared_parameter(instance, model, "tau_m");
    const double moved = -std::expm1(-tick_ms / tau_m_ms);  // 1 - P
    if (population.model == ModelKind::LifDelta) {
      return shared_parameter(instance, model, "R_m") * amplitude * moved;
    }
    const double tau_ms = tick_ms / kReceptorTausPerTick;
    const double response =
        tau_ms / (tau_ms - tau_m_ms) * (std::exp(-tick_ms / tau_ms) - std::exp(-tick_ms / tau_m_ms));  // B / R_m
    return amplitude * moved / response;
  }

  void add_projection(PopulationId source, const Endpoint& target, const Instance& instance, std::uint32_t receptor,
                      double weight) {
    Projection& made = v_.circuit.projections.emplace_back();
    made.name = "stimuli." + decl_.name.text;
    made.name_span = decl_.name.span;
    made.from.push_back({source, {}, 0});
    Endpoint to = target;
    to.receptor = receptor;
    to.fixed_sides.assign(instance.sides.size(), std::nullopt);
    for (std::size_t a = 0; a < instance.sides.size(); ++a) {
      to.fixed_sides[a] = instance.sides[a];
    }
    made.to.push_back(std::move(to));
    made.is_inhibitory = weight < 0;
    made.weight.constant = std::abs(weight);
    made.delay.constant = v_.circuit.tick_ms();
    made.delay.dimension = kTime;
    made.weight_span = decl_.amplitude.span;
    made.delay_span = decl_.at.span;
    made.cite = "stimulus";
  }

  Validation& v_;
  const StimulusDecl& decl_;
};

}  // namespace

void validate_stimuli(Validation& v) {
  for (const StimulusDecl& decl : v.decl.stimuli) {
    StimulusValidator(v, decl).run();
  }
}

}  // namespace tectum
