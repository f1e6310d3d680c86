#include "compiler/validate/neuron_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "compiler/diagnostics/counted.h"
#include "compiler/expression/random_stream.h"
#include "compiler/validate/slot_use.h"

namespace tectum {
namespace {

/// Variables of a neuron parameter's expression, as evaluator slots; the side of axis a follows.
enum NeuronVariable : std::uint32_t { kIndex, kPosition, kSize, kRandom, kX, kY, kEccentricity, kFirstSide };

/// The model's unit as dimension and scale. Units with a product below the line are written with brackets there.
Unit unit_of(const ParameterInfo& info, const Population& population) {
  if (population.user_model) {
    return {*population.user_model->equations.parameter_dimension(info.name), 0, 1};  // coherent
  }
  if (info.unit == "1/(mV ms)") {
    return {*divide(kNumber, *multiply(kVoltage, kTime)), 0, 1};
  }
  return parse_unit(info.unit).value_or(Unit{});
}

class ParameterEvaluator {
 public:
  ParameterEvaluator(Validation& v, Population& population, const ModelInfo& model)
      : v_(v), population_(population), model_(model) {
    columns_.assign(kFirstSide + population.axes.size(), {});
    columns_[kSize] = {static_cast<double>(population.size)};
    names_.outer = &v.scope.environment;
    names_.add_variable("index", kNumber, kIndex);
    names_.add_variable("pos", kNumber, kPosition);
    names_.add_variable("size", kNumber, kSize);
    names_.add_variable("random", kNumber, kRandom);
    for (std::uint32_t a = 0; a < population.axes.size(); ++a) {
      const std::string& axis = v.circuit.axes[index_of(population.axes[a])].name;
      names_.add_variable("side." + axis, kWord, kFirstSide + a);
      if (population.axes.size() == 1) {
        names_.add_variable("side", kWord, kFirstSide);
      }
    }
    if (population.model == ModelKind::FieldSource) {
      add_geometry_names(kAngle);
    }
  }

  /// Neurons of the population lie at (x, y), both angles, both lengths or both plain numbers. False when that is
  /// wrong, which has then been reported.
  bool position(const std::vector<KeyedValue>& position) {
    if (position.empty()) {
      return true;
    }
    std::optional<Dimension> dimension;
    for (const KeyedValue& keyed : position) {
      const auto typed = typed_values(keyed);
      if (typed.empty()) {
        return false;
      }
      const Dimension found = typed.front().dimension;
      if (found != kAngle && found != kLength && found != kNumber) {
        v_.diagnostics().add(Code::WrongDimension, keyed.span,
                             {keyed.key.text, "an angle, a length or a number", describe(found)});
        return false;
      }
      if (dimension && found != *dimension) {
        v_.scope.report_dimension(keyed.values.front(), keyed.key.text, *dimension, found);
        return false;
      }
      dimension = found;
      for_each_side({}, [&](Instance& instance) {
        (keyed.key.text == "x" ? instance.x : instance.y) = spread(evaluate(typed, keyed.key.text, instance));
      });
    }
    population_.position_dimension = dimension;
    add_geometry_names(*dimension);
    return true;
  }

  /// Fills parameter `info` of every side, or of those called `side`.
  void apply(const KeyedValue& keyed, const ParameterInfo& info, const std::string& side) {
    const std::vector<TypedExpression> typed = typed_values(keyed);
    if (typed.empty()) {
      return;
    }
    const Unit unit = unit_of(info, population_);
    for (std::size_t i = 0; i < typed.size(); ++i) {
      // The literature writes Izhikevich's coefficients as plain numbers, in mV and ms.
      const bool takes_plain = model_.kind == ModelKind::Izhikevich && typed[i].dimension.is_number();
      if (typed[i].dimension != unit.dimension && !takes_plain) {
        v_.scope.report_dimension(keyed.values[i], info.name, unit.dimension, typed[i].dimension);
        return;
      }
    }
    const bool varies = typed.size() > 1 || (typed.size() == 1 && !typed.front().constant);
    if (varies && !info.may_vary && !depends_on_side_only(typed)) {
      v_.diagnostics().add(Code::CannotVary, keyed.span, {std::string(info.name)});
      return;
    }
    bool is_sound = true;
    for_each_side(side, [&](Instance& instance) {
      std::vector<double> values = evaluate(typed, keyed.key.text, instance);
      const bool is_plain = typed.front().dimension.is_number();
      for (double& value : values) {
        value = is_plain ? value : from_coherent(value, unit);
      }
      if (std::all_of(values.begin(), values.end(), [&](double x) { return x == values.front(); })) {
        values.resize(1);
      }
      is_sound = is_sound && check_range(keyed, info, values);
      instance.parameters[std::string(info.name)] = std::move(values);
    });
  }

 private:
  void add_geometry_names(const Dimension& dimension) {
    names_.add_variable("x", dimension, kX);
    names_.add_variable("y", dimension, kY);
    if (population_.model == ModelKind::FieldSource) {
      names_.add_variable("ecc", dimension, kEccentricity);
    }
  }

  template <typename Do>
  void for_each_side(const std::string& side, const Do& what) {
    for (std::uint32_t i = 0; i < population_.instance_count; ++i) {
      Instance& instance = v_.circuit.instances[index_of(population_.first_instance) + i];
      bool matches = side.empty();
      for (std::size_t a = 0; a < instance.sides.size(); ++a) {
        const Axis& axis = v_.circuit.axes[index_of(population_.axes[a])];
        matches = matches || axis.sides[instance.sides[a]] == side;
      }
      if (matches) {
        what(instance);
      }
    }
  }

  /// Empty when something is wrong, which has then been reported.
  std::vector<TypedExpression> typed_values(const KeyedValue& keyed) {
    std::vector<TypedExpression> typed;
    if (keyed.is_list && keyed.values.size() != population_.size) {
      v_.diagnostics().add(Code::WrongCount, keyed.span,
                           {fmt::format("`{}`", keyed.key.text), counted(keyed.values.size(), "value"),
                            fmt::format("{}, one a neuron", population_.size)});
      return typed;
    }
    for (const ValueDecl& value : keyed.values) {
      auto expression = v_.scope.expression(value, names_);
      if (!expression) {
        return {};
      }
      typed.push_back(std::move(*expression));
    }
    return typed;
  }

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

  /// One value for all neurons, or one a neuron.
  std::vector<double> evaluate(const std::vector<TypedExpression>& typed, const std::string& name,
                               const Instance& instance) {
    draw(typed, name);
    if (typed.size() == 1) {
      return evaluate_for(typed.front(), instance);
    }
    std::vector<double> values;  // a list: item i belongs to neuron i
    for (std::size_t i = 0; i < typed.size(); ++i) {
      values.push_back(evaluate_for(typed[i], instance)[typed[i].constant ? 0 : i]);
    }
    return values;
  }

  std::vector<double> evaluate_for(const TypedExpression& typed, const Instance& instance) {
    if (typed.constant) {
      return {*typed.constant};
    }
    fill_indices();
    columns_[kX] = instance.x;
    columns_[kY] = instance.y;
    columns_[kEccentricity] = instance.ecc;
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

  std::vector<double> spread(std::vector<double> values) const {
    values.resize(population_.size, values.front());
    return values;
  }

  /// Only when an expression asks: most populations give constants.
  void fill_indices() {
    if (!columns_[kIndex].empty()) {
      return;
    }
    for (std::uint32_t i = 0; i < population_.size; ++i) {
      columns_[kIndex].push_back(i);
      columns_[kPosition].push_back((i + 0.5) / population_.size);
    }
  }

  /// A number in [0, 1) for each neuron, keyed by population and parameter, so that the two sides of a pair are alike.
  void draw(const std::vector<TypedExpression>& typed, const std::string& name) {
    const bool is_used = std::any_of(typed.begin(), typed.end(), [](const TypedExpression& expression) {
      const std::vector<std::uint32_t> slots = slots_read(expression);
      return std::find(slots.begin(), slots.end(), kRandom) != slots.end();
    });
    if (!is_used) {
      return;
    }
    const RandomStream random(v_.circuit.seed, "neurons\n" + population_.name + "\n" + name);
    columns_[kRandom].resize(population_.size);
    for (std::uint32_t i = 0; i < population_.size; ++i) {
      columns_[kRandom][i] = random.uniform(i);
    }
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
        report_range(keyed, info, value);
        return false;
      }
      if (!population_.user_model && info.name == "t_ref" && v_.scope.knows_tick &&
          !whole_ticks(value, v_.circuit.tick_ns)) {
        v_.diagnostics().add(Code::TimeNotTicks, keyed.span,
                             {"t_ref", shown(value, kTime), shown(v_.circuit.tick_ms(), kTime)});
        return false;
      }
      if (!population_.user_model && info.name == "rate" && v_.scope.knows_tick &&
          value * v_.circuit.tick_ms() > 1000 * (1 + 1e-9)) {
        v_.diagnostics().add(Code::OutOfRange, keyed.span,
                             {"rate", fmt::format("{:g} Hz", value),
                              fmt::format("at most one spike a tick, {:g} Hz", 1000 / v_.circuit.tick_ms())});
        return false;
      }
    }
    return true;
  }

  void report_range(const KeyedValue& keyed, const ParameterInfo& info, double value) {
    const std::string unit = info.unit.empty() ? "" : fmt::format(" {}", info.unit);
    const std::string range =
        std::isfinite(info.maximum)
            ? fmt::format("{:g} to {:g}{}", info.minimum, info.maximum, unit)
            : fmt::format("{} {:g}{}", info.minimum_is_allowed ? "at least" : "above", info.minimum, unit);
    v_.diagnostics().add(Code::OutOfRange, keyed.span,
                         {std::string(info.name), fmt::format("{:g}{}", value, unit), range});
  }

  Validation& v_;
  Population& population_;
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

void check_reset(Validation& v, const Population& population, const ModelInfo& model,
                 const std::vector<KeyedValue>& parameters, Span span) {
  if (population.user_model || !find_parameter(model, "V_reset")) {
    return;
  }
  for (const KeyedValue& keyed : parameters) {
    span = keyed.key.text == "V_th" || keyed.key.text == "V_reset" ? keyed.span : span;
  }
  for (std::uint32_t k = 0; k < population.instance_count; ++k) {
    const Instance& instance = v.circuit.instances[index_of(population.first_instance) + k];
    const bool is_given = instance.parameters.count("V_reset") != 0 || instance.parameters.count("V_th") != 0;
    for (std::uint32_t i = 0; i < (is_given ? population.size : 1U); ++i) {
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

/// Returns the key that may have been meant.
std::optional<std::string> report_unknown_parameter(Validation& v, const KeyedValue& keyed, const ModelInfo& model) {
  std::vector<std::string> names = {"neuron",   "input",      "size", "axis", "nucleus",
                                    "position", "exceptions", "cite", "about"};
  for (const ParameterInfo& info : model.parameters) {
    names.emplace_back(info.name);
  }
  if (((model.receptor_kinds >> static_cast<std::uint32_t>(ReceptorKind::Exponential)) & 1U) != 0) {
    names.insert(names.end(), {"tau_syn_ex", "tau_syn_in"});
  }
  const std::optional<std::string> nearest = nearest_name(keyed.key.text, names);
  v.diagnostics()
      .add(Code::UnknownParameter, keyed.key.span, {"model", std::string(model.name), keyed.key.text})
      .help_if(nearest, "did you mean `{}`?");
  return nearest;
}

bool has_side(const Validation& v, const Population& population, const std::string& side) {
  return std::any_of(population.axes.begin(), population.axes.end(), [&](AxisId id) {
    const std::vector<std::string>& sides = v.circuit.axes[index_of(id)].sides;
    return std::find(sides.begin(), sides.end(), side) != sides.end();
  });
}

/// Returns the key that may have been meant where this one is unknown.
std::optional<std::string> apply_one(Validation& v, const Population& population, const ModelInfo& model,
                                     const KeyedValue& keyed, const std::string& side, ParameterEvaluator& evaluator) {
  if (model.kind == ModelKind::SpikeList && keyed.key.text == "times") {
    apply_times(v, population, keyed);
  } else if (const auto p = find_parameter(model, keyed.key.text)) {
    evaluator.apply(keyed, model.parameters[*p], side);
  } else {
    return report_unknown_parameter(v, keyed, model);
  }
  return std::nullopt;
}

}  // namespace

void check_parameters(Validation& v, Population& population, const ModelInfo& model,
                      const std::vector<KeyedValue>& parameters) {
  ParameterEvaluator evaluator(v, population, model);
  for (const KeyedValue& keyed : parameters) {
    static_cast<void>(apply_one(v, population, model, keyed, "", evaluator));
  }
}

bool apply_parameters(Validation& v, Population& population, const ModelInfo& model, const ParameterSources& sources,
                      const NameDecl& owner) {
  const std::size_t trouble_before = v.scope.trouble_count();
  const std::set<std::string> broken = v.scope.broken;
  ParameterEvaluator evaluator(v, population, model);
  const bool knows_places = evaluator.position(sources.position);
  if (!knows_places) {
    v.scope.broken.insert({"x", "y"});
  }
  for (const KeyedValue& keyed : sources.parameters) {
    if (apply_one(v, population, model, keyed, "", evaluator) == "axis") {
      v.knows_sides.back() = false;  // what would follow from its having no sides is not reported
    }
  }
  for (const ExceptionDecl& exception : sources.exceptions) {
    if (!v.knows_sides.back()) {
      continue;
    }
    if (!has_side(v, population, exception.side.text)) {
      v.diagnostics().add(Code::UnknownSide, exception.side.span, {population.name, exception.side.text});
      continue;
    }
    for (const KeyedValue& keyed : exception.values) {
      static_cast<void>(apply_one(v, population, model, keyed, exception.side.text, evaluator));
    }
  }
  for (const ParameterInfo& info : model.parameters) {
    const bool is_given = std::any_of(sources.parameters.begin(), sources.parameters.end(),
                                      [&](const KeyedValue& p) { return p.key.text == info.name; });
    if (info.is_required && !is_given) {
      v.diagnostics().add(Code::MissingKey, owner.span,
                          {fmt::format("`{}`, a {},", owner.text, model.name), std::string(info.name)});
    }
  }
  if (v.scope.trouble_count() == trouble_before) {
    check_reset(v, population, model, sources.parameters, owner.span);
  }
  v.scope.broken = broken;
  return knows_places && v.knows_sides.back();
}

}  // namespace tectum
