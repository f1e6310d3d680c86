// Populations: their neurons' parameters as numbers, one set a side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compiler/validate/resolve_neurons.h"
#include "compiler/validate/retina_geometry.h"
#include "compiler/validate/slot_use.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

constexpr std::uint64_t kMaxNeurons = std::uint64_t{1} << 28U;

/// Variables of a neuron parameter's expression, as evaluator slots; the side of axis a follows.
enum NeuronVariable : std::uint32_t { kIndex, kPosition, kSize, kX, kY, kEccentricity, kFirstSide };

/// The model's unit as dimension and scale. Units with a product below the line are written with brackets there.
Unit unit_of(const ParameterInfo& info) {
  if (info.unit == "1/(mV ms)") {
    return {*divide(kNumber, *multiply(kVoltage, kTime)), 0, 1};
  }
  return parse_unit(info.unit).value_or(Unit{});
}

Environment neuron_environment(const Validation& v, const Population& population, bool has_geometry) {
  Environment names;
  names.outer = &v.scope.environment;
  names.add_variable("index", kNumber, kIndex);
  names.add_variable("pos", kNumber, kPosition);
  names.add_variable("size", kNumber, kSize);
  if (has_geometry) {
    names.add_variable("x", kAngle, kX);
    names.add_variable("y", kAngle, kY);
    names.add_variable("ecc", kAngle, kEccentricity);
  }
  for (std::uint32_t a = 0; a < population.axes.size(); ++a) {
    const std::string& axis = v.circuit.axes[index_of(population.axes[a])].name;
    names.add_variable("side." + axis, kWord, kFirstSide + a);
    if (population.axes.size() == 1) {
      names.add_variable("side", kWord, kFirstSide);
    }
  }
  return names;
}

class ParameterEvaluator {
 public:
  ParameterEvaluator(Validation& v, const Population& population, const ModelInfo& model, const RetinaSheet* retina)
      : v_(v), population_(population), model_(model), names_(neuron_environment(v, population, retina != nullptr)) {
    columns_.assign(kFirstSide + population.axes.size(), {});
    for (std::uint32_t i = 0; i < population.size; ++i) {
      columns_[kIndex].push_back(i);
      columns_[kPosition].push_back((i + 0.5) / population.size);
    }
    columns_[kSize] = {static_cast<double>(population.size)};
    if (retina != nullptr) {
      for (const FieldRecord& field : retina->fields) {
        const FieldAngles angles =
            field_angles(field, retina->frame_width, retina->frame_height, retina->field_of_view_deg);
        columns_[kX].push_back(angles.x_deg);
        columns_[kY].push_back(angles.y_deg);
        columns_[kEccentricity].push_back(angles.ecc_deg);
      }
    }
  }

  /// Fills parameter `info` of every side.
  void apply(const KeyedValue& keyed, const ParameterInfo& info) {
    const Unit unit = unit_of(info);
    if (keyed.is_list && keyed.values.size() != population_.size) {
      v_.diagnostics().add(Code::WrongCount, keyed.span,
                           {fmt::format("`{}`", info.name), fmt::format("{}", keyed.values.size()),
                            fmt::format("{}, one a neuron", population_.size)});
      return;
    }
    std::vector<TypedExpression> typed;
    for (const ValueDecl& value : keyed.values) {
      auto expression = v_.scope.expression(value, names_);
      if (!expression) {
        return;
      }
      // The literature writes Izhikevich's coefficients as plain numbers, in mV and ms.
      const bool takes_plain = model_.kind == ModelKind::Izhikevich && expression->dimension.is_number();
      if (expression->dimension != unit.dimension && !takes_plain) {
        v_.scope.report_dimension(value, info.name, unit.dimension, expression->dimension);
        return;
      }
      typed.push_back(std::move(*expression));
    }
    const bool varies = typed.size() > 1 || (typed.size() == 1 && !typed.front().constant);
    if (varies && !info.may_vary && !depends_on_side_only(typed)) {
      v_.diagnostics().add(Code::CannotVary, keyed.span, {std::string(info.name)});
      return;
    }
    for (std::uint32_t i = 0; i < population_.instance_count; ++i) {
      Instance& instance = v_.circuit.instances[index_of(population_.first_instance) + i];
      std::vector<double> values = evaluate(typed, instance);
      const bool is_plain = typed.front().dimension.is_number();
      for (double& value : values) {
        value = is_plain ? value : from_coherent(value, unit);
      }
      if (std::all_of(values.begin(), values.end(), [&](double x) { return x == values.front(); })) {
        values.resize(1);
      }
      if (!check_range(keyed, info, values)) {
        return;
      }
      instance.parameters[std::string(info.name)] = std::move(values);
    }
  }

 private:
  static bool depends_on_side_only(const std::vector<TypedExpression>& typed) {
    for (const TypedExpression& expression : typed) {
      for (const std::uint32_t slot : slots_read(expression)) {
        if (slot < kFirstSide && slot != kSize) {
          return false;
        }
      }
    }
    return typed.size() == 1;
  }

  std::vector<double> evaluate(const std::vector<TypedExpression>& typed, const Instance& instance) {
    std::vector<double> values;
    if (typed.size() > 1) {
      // A list: item i belongs to neuron i.
      for (std::size_t i = 0; i < typed.size(); ++i) {
        values.push_back(evaluate_for(typed[i], instance)[typed[i].constant ? 0 : i]);
      }
      return values;
    }
    return evaluate_for(typed.front(), instance);
  }

  std::vector<double> evaluate_for(const TypedExpression& typed, const Instance& instance) {
    if (typed.constant) {
      return {*typed.constant};
    }
    for (std::size_t a = 0; a < instance.sides.size(); ++a) {
      const Axis& axis = v_.circuit.axes[index_of(population_.axes[a])];
      columns_[kFirstSide + a] = {static_cast<double>(v_.circuit.words.at(axis.sides[instance.sides[a]]))};
    }
    std::vector<EvalColumn> columns;
    for (const std::vector<double>& column : columns_) {
      columns.push_back({column.data(), column.size() == population_.size && column.size() > 1 ? 1U : 0U});
    }
    std::vector<double> values(population_.size);
    Evaluator(typed).evaluate(columns, values);
    return values;
  }

  bool check_range(const KeyedValue& keyed, const ParameterInfo& info, const std::vector<double>& values) {
    for (const double value : values) {
      const bool is_above = info.minimum_is_allowed ? value >= info.minimum : value > info.minimum;
      if (!std::isfinite(value)) {
        v_.diagnostics().add(Code::NotFinite, keyed.span,
                             {fmt::format("`{}` is not finite for some neuron", info.name)});
        return false;
      }
      if (!is_above || value > info.maximum) {
        std::string range =
            fmt::format("{} {:g} {}", info.minimum_is_allowed ? "at least" : "above", info.minimum, info.unit);
        if (std::isfinite(info.maximum)) {
          range = fmt::format("{:g} to {:g} {}", info.minimum, info.maximum, info.unit);
        }
        range.erase(range.find_last_not_of(' ') + 1);
        const std::string text = fmt::format("{:g}{}{}", value, info.unit.empty() ? "" : " ", info.unit);
        v_.diagnostics().add(Code::OutOfRange, keyed.span, {std::string(info.name), text, range});
        return false;
      }
      if (info.name == "t_ref" && !whole_ticks(value, v_.circuit.tick_ns)) {
        v_.diagnostics().add(Code::TimeNotTicks, keyed.span,
                             {"t_ref", shown(value, kTime), shown(v_.circuit.tick_ms(), kTime)});
        return false;
      }
    }
    return true;
  }

  Validation& v_;
  const Population& population_;
  const ModelInfo& model_;
  Environment names_;
  std::vector<std::vector<double>> columns_;
};

/// Value of parameter `name` of neuron i, with the model's default.
double effective(const Instance& instance, const ModelInfo& model, const char* name, std::size_t i) {
  const auto found = instance.parameters.find(name);
  if (found != instance.parameters.end()) {
    return found->second.size() == 1 ? found->second.front() : found->second[i];
  }
  return model.parameters[*find_parameter(model, name)].default_value;
}

void check_reset(Validation& v, const Population& population, const ModelInfo& model, Span span) {
  if (!find_parameter(model, "V_reset")) {
    return;
  }
  for (std::uint32_t k = 0; k < population.instance_count; ++k) {
    const Instance& instance = v.circuit.instances[index_of(population.first_instance) + k];
    for (std::uint32_t i = 0; i < population.size; ++i) {
      const double reset_mv = effective(instance, model, "V_reset", i);
      const double threshold_mv = effective(instance, model, "V_th", i);
      if (!(reset_mv < threshold_mv)) {
        v.diagnostics().add(Code::ThresholdBelowReset, span,
                            {shown(reset_mv, kVoltage), shown(threshold_mv, kVoltage)});
        return;
      }
    }
  }
}

/// "times" of a spike_list, the same for each neuron.
void apply_times(Validation& v, const Population& population, const KeyedValue& keyed) {
  std::vector<std::uint32_t> ticks;
  for (const ValueDecl& value : keyed.values) {
    if (const auto tick = v.scope.ticks(value, "times", v.circuit.tick_ns)) {
      ticks.push_back(static_cast<std::uint32_t>(std::min<std::uint64_t>(*tick, 0xFFFFFFFEU)));
    }
  }
  std::sort(ticks.begin(), ticks.end());
  ticks.erase(std::unique(ticks.begin(), ticks.end()), ticks.end());
  for (std::uint32_t i = 0; i < population.instance_count; ++i) {
    v.circuit.instances[index_of(population.first_instance) + i].spike_ticks = ticks;
  }
}

/// Keys of a population that are no parameters, for suggestions.
const std::vector<std::string> kPopulationKeys = {"neuron", "input", "size", "axis", "nucleus", "cite", "about"};

void report_unknown_parameter(Validation& v, const KeyedValue& keyed, const ModelInfo& model) {
  std::vector<std::string> names = kPopulationKeys;
  for (const ParameterInfo& info : model.parameters) {
    names.emplace_back(info.name);
  }
  if (((model.receptor_kinds >> static_cast<std::uint32_t>(ReceptorKind::Exponential)) & 1U) != 0) {
    names.insert(names.end(), {"tau_syn_ex", "tau_syn_in"});
  }
  v.diagnostics()
      .add(Code::UnknownParameter, keyed.key.span, {std::string(model.name), keyed.key.text})
      .help_if(nearest_name(keyed.key.text, names), "did you mean `{}`?");
}

void apply_parameters(Validation& v, const Population& population, const ModelInfo& model,
                      const std::vector<KeyedValue>& parameters, const RetinaSheet* retina, const NameDecl& owner) {
  const std::size_t errors_before = v.diagnostics().error_count();
  ParameterEvaluator evaluator(v, population, model, retina);
  for (const KeyedValue& keyed : parameters) {
    if (model.kind == ModelKind::SpikeList && keyed.key.text == "times") {
      apply_times(v, population, keyed);
    } else if (const auto p = find_parameter(model, keyed.key.text)) {
      evaluator.apply(keyed, model.parameters[*p]);
    } else {
      report_unknown_parameter(v, keyed, model);
    }
  }
  for (const ParameterInfo& info : model.parameters) {
    const bool is_given =
        std::any_of(parameters.begin(), parameters.end(), [&](const KeyedValue& p) { return p.key.text == info.name; });
    if (info.is_required && !is_given) {
      v.diagnostics().add(Code::MissingKey, owner.span,
                          {fmt::format("`{}`, a {},", owner.text, model.name), std::string(info.name)});
    }
  }
  if (v.diagnostics().error_count() == errors_before) {
    check_reset(v, population, model, owner.span);
  }
}

class PopulationValidator {
 public:
  explicit PopulationValidator(Validation& v) : v_(v), neurons_(resolve_neurons(v)) {}

  void run() {
    for (const PopulationDecl& decl : v_.decl.populations) {
      v_.population_of.emplace(decl.name.text, static_cast<std::uint32_t>(v_.circuit.populations.size()));
      const std::size_t errors_before = v_.diagnostics().error_count();
      is_usable_ = true;
      one(decl, v_.circuit.populations.emplace_back());
      v_.is_sound.push_back(is_usable_ && v_.diagnostics().error_count() == errors_before);
    }
    if (total_ > kMaxNeurons) {
      v_.diagnostics().add(Code::TooManyNeurons, v_.decl.populations.back().name.span,
                           {fmt::format("{}", total_), fmt::format("{}", kMaxNeurons)});
    }
  }

 private:
  void one(const PopulationDecl& decl, Population& population) {
    population.name = decl.name.text;
    population.name_span = decl.name.span;
    population.nucleus = decl.nucleus ? decl.nucleus->text : "";
    v_.check_cites(decl.provenance);
    axes(decl, population);
    add_instances(population);
    const RetinaSheet* retina = nullptr;
    const ModelInfo* model = nullptr;
    std::vector<KeyedValue> parameters;
    if (!decl.inputs.empty()) {
      model = find_model(ModelKind::FieldSource);
      retina = inputs(decl, population);
      parameters = decl.overrides;
    } else {
      model = neuron(decl, population, parameters);
    }
    if (model == nullptr) {
      is_usable_ = false;
      return;
    }
    population.model = model->kind;
    population.may_sleep = model->may_sleep;
    if (decl.size && decl.inputs.empty()) {
      population.size = static_cast<std::uint32_t>(v_.scope.whole(*decl.size, "size", 1, kMaxNeurons).value_or(0));
    } else if (decl.size) {
      v_.diagnostics()
          .add(Code::KeysExclude, decl.size->span, {"size", "input"})
          .help("a retina has one neuron a field");
    }
    total_ += std::uint64_t{population.size} * population.instance_count;
    if (population.size == 0 || total_ > kMaxNeurons) {
      is_usable_ = false;
      return;
    }
    apply_parameters(v_, population, *model, parameters, retina, decl.name);
  }

  void axes(const PopulationDecl& decl, Population& population) {
    for (const NameDecl& name : decl.axes) {
      const auto found = v_.axis_of.find(name.text);
      if (found == v_.axis_of.end()) {
        v_.diagnostics()
            .add(Code::UnknownAxis, name.span, {name.text})
            .help_if(nearest_name(name.text, names_of(v_.decl.axes)), "did you mean `{}`?");
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
      population.receptors = resolve_receptors(v_, *neurons_[i], parameters);
      return neurons_[i]->model;
    }
    v_.diagnostics()
        .add(Code::UnknownNeuron, decl.neuron->span, {decl.neuron->text})
        .help_if(nearest_name(decl.neuron->text, names_of(v_.decl.neurons)), "did you mean `{}`?");
    return nullptr;
  }

  /// The retinas behind each side; they must be of one size. Returns the first.
  const RetinaSheet* inputs(const PopulationDecl& decl, Population& population) {
    const RetinaSheet* first = nullptr;
    for (const InputUseDecl& use : decl.inputs) {
      const auto found = v_.retina_of.find(use.input.text);
      if (found == v_.retina_of.end()) {
        v_.diagnostics()
            .add(Code::UnknownInput, use.input.span, {use.input.text})
            .help_if(nearest_name(use.input.text, names_of(v_.decl.retinas)), "did you mean `{}`?");
        continue;
      }
      const RetinaSheet& retina = v_.circuit.retinas[found->second];
      is_usable_ = is_usable_ && v_.is_sound_retina[found->second];
      if (first != nullptr && retina.fields.size() != first->fields.size()) {
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
    return first;
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
        found_side = true;
      }
    }
    if (!found_side && is_usable_) {
      v_.diagnostics().add(Code::UnknownSide, use.side.span, {population.name, use.side.text});
    }
  }

  Validation& v_;
  std::vector<std::optional<ResolvedNeuron>> neurons_;
  std::uint64_t total_ = 0;
  bool is_usable_ = true;
};

}  // namespace

void validate_populations(Validation& v) { PopulationValidator(v).run(); }

std::optional<Endpoint> Validation::endpoint(const NameDecl& name) {
  const std::size_t dot = name.text.find('.');
  const std::string base = name.text.substr(0, dot);
  const auto found = population_of.find(base);
  if (found == population_of.end()) {
    const Span span{name.span.file, name.span.begin,
                    dot == std::string::npos ? name.span.end : name.span.begin + static_cast<std::uint32_t>(dot)};
    diagnostics()
        .add(Code::UnknownPopulation, span, {base})
        .help_if(nearest_name(base, names_of(decl.populations)), "did you mean `{}`?");
    return std::nullopt;
  }
  Endpoint endpoint;
  endpoint.population = static_cast<PopulationId>(found->second);
  const Population& population = circuit.populations[found->second];
  endpoint.fixed_sides.resize(population.axes.size());
  for (std::size_t at = dot; at != std::string::npos;) {
    const std::size_t next = name.text.find('.', at + 1);
    const std::string side = name.text.substr(at + 1, next == std::string::npos ? next : next - at - 1);
    bool is_known = false;
    std::vector<std::string> sides;
    for (std::size_t a = 0; a < population.axes.size() && !is_known; ++a) {
      const Axis& axis = circuit.axes[index_of(population.axes[a])];
      sides.insert(sides.end(), axis.sides.begin(), axis.sides.end());
      const auto position = std::find(axis.sides.begin(), axis.sides.end(), side);
      if (position != axis.sides.end() && !endpoint.fixed_sides[a]) {
        endpoint.fixed_sides[a] = static_cast<std::uint32_t>(position - axis.sides.begin());
        is_known = true;
      }
    }
    if (!is_known) {
      const auto begin = name.span.begin + static_cast<std::uint32_t>(at) + 1;
      auto builder = diagnostics().add(
          Code::UnknownSide, {name.span.file, begin, begin + static_cast<std::uint32_t>(side.size())}, {base, side});
      if (population.axes.empty()) {
        builder.help(fmt::format("`{}` is on no axis", base));
      } else {
        builder.help_if(nearest_name(side, sides), "did you mean `{}`?");
      }
      return std::nullopt;
    }
    at = next;
  }
  return endpoint;
}

}  // namespace tectum
