// Populations: their neurons' parameters as numbers, one set a side.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "compiler/validate/neuron_parameters.h"
#include "compiler/validate/resolve_neurons.h"
#include "compiler/validate/retina_geometry.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

constexpr std::uint64_t kMaxNeurons = std::uint64_t{1} << 28U;
// Smaller populations stay in the first cache: to sweep them is cheaper than to keep account of who sleeps.
constexpr std::uint32_t kSleepFromNeurons = 4096;

class PopulationValidator {
 public:
  explicit PopulationValidator(Validation& v) : v_(v), neurons_(resolve_neurons(v)), is_used_(neurons_.size(), false) {}

  void run() {
    for (const PopulationDecl& decl : v_.decl.populations) {
      v_.population_of.emplace(decl.name.text, static_cast<std::uint32_t>(v_.circuit.populations.size()));
      is_usable_ = true;
      neuron_number_.reset();
      one(decl, v_.circuit.populations.emplace_back());
      v_.is_sound.push_back(is_usable_);
    }
    unused_neurons();
    if (total_ > kMaxNeurons) {
      v_.diagnostics().add(Code::TooManyNeurons, v_.decl.populations.back().name.span,
                           {fmt::format("{}", total_), fmt::format("{}", kMaxNeurons)});
    }
  }

 private:
  void one(const PopulationDecl& decl, Population& population) {
    population.name = decl.name.text;
    population.name_span = decl.name.span;
    population.may_mix_signs = !decl.mixed_signs.empty();
    population.nucleus = decl.nucleus ? decl.nucleus->text : "";
    v_.check_cites(decl.provenance);
    axes(decl, population);
    v_.knows_sides.push_back(is_usable_);
    add_instances(population);
    const ModelInfo* model = nullptr;
    std::vector<KeyedValue> parameters;
    if (!decl.inputs.empty()) {
      model = find_model(ModelKind::FieldSource);
      inputs(decl, population);
      parameters = decl.overrides;
    } else {
      model = neuron(decl, population, parameters);
    }
    if (decl.cells) {
      cells(decl, population);
    } else if (decl.size && decl.inputs.empty()) {
      population.size = static_cast<std::uint32_t>(v_.scope.whole(*decl.size, "size", 1, kMaxNeurons).value_or(0));
    } else if (decl.size) {
      v_.diagnostics()
          .add(Code::KeysExclude, decl.size->span, {"size", "input"})
          .help("a retina has one neuron a field");
    }
    if (model == nullptr) {
      is_usable_ = false;
      return;
    }
    population.model = model->kind;
    population.may_sleep = model->may_sleep && population.size >= kSleepFromNeurons;
    total_ += std::uint64_t{population.size} * population.instance_count;
    if (population.size == 0 || total_ > kMaxNeurons) {
      is_usable_ = false;
      return;
    }
    if (neuron_number_) {
      is_used_[*neuron_number_] = true;
    }
    const std::size_t trouble_before = v_.scope.trouble_count();
    const bool knows_places =
        apply_parameters(v_, population, *model, {parameters, decl.exceptions, decl.position}, decl.name);
    is_usable_ = is_usable_ && knows_places;
    if (population.user_model && v_.scope.trouble_count() == trouble_before) {
      check_user_model(v_, population, decl.name);
    }
  }

  /// Its neurons are cells that a file lists.
  void cells(const PopulationDecl& decl, Population& population) {
    const char* other = decl.size ? "size" : !decl.inputs.empty() ? "input" : !decl.axes.empty() ? "axis" : nullptr;
    if (other != nullptr) {
      v_.diagnostics()
          .add(Code::KeysExclude, decl.cells->table.span, {"cells", other})
          .help("measured sides rarely have as many cells each: write one population a side");
      is_usable_ = false;
      return;
    }
    const auto instance = static_cast<std::uint32_t>(index_of(population.first_instance));
    population.size = assign_cells(v_, *decl.cells, instance, population).value_or(0);
  }

  /// A neuron type that no population brought this far is checked on a population of one.
  void unused_neurons() {
    // Names that only a real population gives a meaning to.
    const std::set<std::string> broken = v_.scope.broken;
    v_.scope.broken.insert({"side", "x", "y", "ecc"});
    for (const Axis& axis : v_.circuit.axes) {
      v_.scope.broken.insert("side." + axis.name);
    }
    for (std::size_t i = 0; i < neurons_.size(); ++i) {
      if (is_used_[i] || !neurons_[i]) {
        continue;
      }
      std::vector<KeyedValue> parameters = neurons_[i]->parameters;
      std::erase_if(parameters, [](const KeyedValue& keyed) { return keyed.is_list; });
      static_cast<void>(resolve_receptors(v_, *neurons_[i], parameters));
      Population trial;
      trial.name = neurons_[i]->name.text;
      trial.model = neurons_[i]->model->kind;
      trial.user_model = neurons_[i]->user_model;
      trial.size = 1;
      trial.first_instance = static_cast<InstanceId>(v_.circuit.instances.size());
      v_.circuit.instances.emplace_back();
      check_parameters(v_, trial, *neurons_[i]->model, parameters);
      v_.circuit.instances.pop_back();
    }
    v_.scope.broken = broken;
  }

  void axes(const PopulationDecl& decl, Population& population) {
    for (const NameDecl& name : decl.axes) {
      const auto found = v_.axis_of.find(name.text);
      if (found == v_.axis_of.end()) {
        if (v_.can_report(name, "axes")) {
          const std::vector<std::string> known = names_of(v_.decl.axes);
          const auto nearest = nearest_name(name.text, known);
          auto builder = v_.diagnostics().add(Code::UnknownAxis, name.span, {name.text});
          if (nearest) {
            builder.help_if(nearest, "did you mean `{}`?");
          } else if (known.empty()) {
            builder.help(fmt::format("declare it: \"axes\": {{ \"{}\": [\"one side\", \"the other\"] }}", name.text));
          } else {
            builder.help(fmt::format("the axes are {}", fmt::join(known, ", ")));
          }
        }
        is_usable_ = false;
      } else if (!v_.is_sound_axis[found->second]) {
        is_usable_ = false;
      } else {
        population.axes.push_back(static_cast<AxisId>(found->second));
      }
    }
  }

  /// One a combination of sides, the first axis slowest.
  void add_instances(Population& population) {
    population.first_instance = static_cast<InstanceId>(v_.circuit.instances.size());
    population.instance_count = 1;
    for (const AxisId axis : population.axes) {
      population.instance_count *= static_cast<std::uint32_t>(v_.circuit.axes[index_of(axis)].sides.size());
    }
    for (std::uint32_t i = 0; i < population.instance_count; ++i) {
      Instance& instance = v_.circuit.instances.emplace_back();
      instance.name = population.name;
      instance.population = static_cast<PopulationId>(v_.circuit.populations.size() - 1);
      std::uint32_t rest = population.instance_count;
      std::uint32_t number = i;
      for (const AxisId axis : population.axes) {
        const std::vector<std::string>& sides = v_.circuit.axes[index_of(axis)].sides;
        rest /= static_cast<std::uint32_t>(sides.size());
        instance.sides.push_back(number / rest);
        number %= rest;
        instance.name += "." + sides[instance.sides.back()];
      }
    }
  }

  const ModelInfo* neuron(const PopulationDecl& decl, Population& population, std::vector<KeyedValue>& parameters) {
    if (!decl.neuron) {
      return nullptr;
    }
    for (std::size_t i = 0; i < v_.decl.neurons.size(); ++i) {
      if (v_.decl.neurons[i].name.text != decl.neuron->text) {
        continue;
      }
      if (!neurons_[i]) {
        return nullptr;
      }
      neuron_number_ = i;
      parameters = neurons_[i]->parameters;
      for (const KeyedValue& over : decl.overrides) {
        const auto same = std::find_if(parameters.begin(), parameters.end(),
                                       [&](const KeyedValue& p) { return p.key.text == over.key.text; });
        if (same == parameters.end()) {
          parameters.push_back(over);
        } else {
          *same = over;
        }
      }
      population.user_model = neurons_[i]->user_model;
      population.receptors = resolve_receptors(v_, *neurons_[i], parameters);
      is_usable_ = is_usable_ && !neurons_[i]->has_poisoned_receptors;
      return neurons_[i]->model;
    }
    if (!v_.can_report(*decl.neuron, "neurons")) {
      return nullptr;
    }
    v_.diagnostics()
        .add(Code::UnknownNeuron, decl.neuron->span, {decl.neuron->text})
        .help_if(nearest_name(decl.neuron->text, names_of(v_.decl.neurons)), "did you mean `{}`?");
    return nullptr;
  }

  /// The retinas behind each side; they must be of one size.
  void inputs(const PopulationDecl& decl, Population& population) {
    const RetinaSheet* first = nullptr;
    for (const InputUseDecl& use : decl.inputs) {
      const auto found = v_.retina_of.find(use.input.text);
      if (found == v_.retina_of.end()) {
        if (v_.can_report(use.input, "inputs")) {
          v_.diagnostics()
              .add(Code::UnknownInput, use.input.span, {use.input.text})
              .help_if(nearest_name(use.input.text, names_of(v_.decl.retinas)), "did you mean `{}`?");
        }
        is_usable_ = false;
        continue;
      }
      const RetinaSheet& retina = v_.circuit.retinas[found->second];
      is_usable_ = is_usable_ && v_.is_sound_retina[found->second];
      if (is_usable_ && first != nullptr && retina.fields.size() != first->fields.size()) {
        v_.diagnostics().add(Code::SizesDiffer, use.input.span,
                             {first->name, fmt::format("{}", first->fields.size()), retina.name,
                              fmt::format("{}", retina.fields.size())});
      }
      first = first == nullptr ? &retina : first;
      assign_retina(use, population, static_cast<RetinaId>(found->second));
    }
    for (std::uint32_t i = 0; i < population.instance_count && first != nullptr; ++i) {
      const Instance& instance = v_.circuit.instances[index_of(population.first_instance) + i];
      if (!instance.retina && is_usable_) {
        v_.diagnostics().add(Code::MissingKey, decl.inputs.front().input.span,
                             {fmt::format("`input` of `{}`", instance.name), "retina"});
        is_usable_ = false;
      }
    }
    population.size = first == nullptr ? 0 : static_cast<std::uint32_t>(first->fields.size());
    population.position_dimension = kAngle;
  }

  static void place_fields(Instance& instance, const RetinaSheet& retina) {
    for (const FieldRecord& field : retina.fields) {
      const FieldAngles angles = field_angles(field, retina.frame_width, retina.frame_height, retina.field_of_view_deg);
      instance.x.push_back(angles.x_deg);
      instance.y.push_back(angles.y_deg);
      instance.ecc.push_back(angles.ecc_deg);
    }
  }

  void assign_retina(const InputUseDecl& use, const Population& population, RetinaId id) {
    bool found_side = use.side.text.empty();
    for (std::uint32_t i = 0; i < population.instance_count; ++i) {
      Instance& instance = v_.circuit.instances[index_of(population.first_instance) + i];
      bool matches = use.side.text.empty();
      for (std::size_t a = 0; a < instance.sides.size(); ++a) {
        const Axis& axis = v_.circuit.axes[index_of(population.axes[a])];
        matches = matches || axis.sides[instance.sides[a]] == use.side.text;
      }
      if (matches) {
        instance.retina = id;
        place_fields(instance, v_.circuit.retinas[index_of(id)]);
        found_side = true;
      }
    }
    if (!found_side && is_usable_) {
      v_.diagnostics().add(Code::UnknownSide, use.side.span, {population.name, use.side.text});
    }
  }

  Validation& v_;
  std::vector<std::optional<ResolvedNeuron>> neurons_;
  std::vector<bool> is_used_;
  std::uint64_t total_ = 0;
  bool is_usable_ = true;                     // the population in hand
  std::optional<std::size_t> neuron_number_;  // of the population in hand
};

}  // namespace

void validate_populations(Validation& v) { PopulationValidator(v).run(); }

}  // namespace tectum
