// Projections: endpoints, rule, side relation, receptor, and the expressions over pairs of neurons.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compiler/validate/read_edge_table.h"
#include "compiler/validate/rules.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

class ProjectionValidator {
 public:
  ProjectionValidator(Validation& v, const ProjectionDecl& decl, Projection& made) : v_(v), decl_(decl), made_(made) {}

  void run() {
    made_.name = decl_.name.text;
    made_.name_span = decl_.name.span;
    cites();
    made_.from = endpoints(decl_.from);
    made_.to = endpoints(decl_.to);
    is_sound_ = is_sound_ && !made_.from.empty() && !made_.to.empty();
    sign();
    const bool knows_ends = is_sound_;
    if (knows_ends) {
      sides();
    }
    if (knows_ends) {
      make_environment();
    }
    rule();
    if (!is_sound_) {
      return;  // without its ends or its edge list, nothing more can be said of it that is not a consequence
    }
    if ((decl_.sign && decl_.sign->is_poisoned) || (decl_.receptor && decl_.receptor->is_poisoned)) {
      v_.scope.keep_silent();
    } else {
      receptors();
    }
    weight();
    delay();
    where();
    v_.scope.absent.clear();
    if (decl_.plasticity) {
      made_.plasticity = validate_plasticity(v_, *decl_.plasticity, decl_.to.front().text, known_sides());
    }
    if (made_.rule == RuleKind::OneToOne) {
      check_sizes();
    }
    if (degree_span_) {
      check_degree();
    }
  }

 private:
  void cites() {
    v_.check_cites(decl_.provenance);
    for (const NameDecl& cite : decl_.provenance.cites) {
      made_.cite += (made_.cite.empty() ? "" : ",") + cite.text;
    }
  }

  std::vector<Endpoint> endpoints(const std::vector<NameDecl>& names) {
    std::vector<Endpoint> result;
    for (const NameDecl& name : names) {
      if (auto endpoint = v_.endpoint(name)) {
        is_sound_ = is_sound_ && v_.is_sound[index_of(endpoint->population)];
        result.push_back(std::move(*endpoint));
      } else {
        is_sound_ = false;
      }
    }
    return result;
  }

  const Population& population(const Endpoint& endpoint) const {
    return v_.circuit.populations[index_of(endpoint.population)];
  }

  void sign() {
    if (!decl_.sign) {
      return;
    }
    if (decl_.sign->text == "inhibitory") {
      made_.is_inhibitory = true;
    } else if (decl_.sign->text != "excitatory" && !decl_.sign->is_poisoned) {
      v_.diagnostics()
          .add(Code::UnknownWord, decl_.sign->span, {"sign", decl_.sign->text})
          .help("a sign is `excitatory` or `inhibitory`");
    }
  }

  /// Axes that some source and some target share.
  std::vector<AxisId> shared_axes() const {
    std::vector<AxisId> shared;
    for (const Endpoint& from : made_.from) {
      for (const Endpoint& to : made_.to) {
        for (const AxisId axis : population(from).axes) {
          const auto& other = population(to).axes;
          if (std::find(other.begin(), other.end(), axis) != other.end() &&
              std::find(shared.begin(), shared.end(), axis) == shared.end()) {
            shared.push_back(axis);
          }
        }
      }
    }
    return shared;
  }

  void sides() {
    const std::vector<AxisId> shared = shared_axes();
    for (const SideDecl& side : decl_.side) {
      const auto relation = side.relation.is_poisoned ? std::nullopt : find_relation(side.relation);
      if (!relation) {
        continue;
      }
      std::vector<AxisId> axes = shared;
      if (!side.axis.text.empty()) {
        const auto axis = v_.axis_of.find(side.axis.text);
        if (axis == v_.axis_of.end()) {
          if (v_.can_report(side.axis, "axes")) {
            v_.diagnostics()
                .add(Code::UnknownAxis, side.axis.span, {side.axis.text})
                .help_if(nearest_name(side.axis.text, names_of(v_.decl.axes)), "did you mean `{}`?");
          }
          continue;
        }
        const auto id = static_cast<AxisId>(axis->second);
        axes.clear();
        if (std::find(shared.begin(), shared.end(), id) != shared.end()) {
          axes.push_back(id);
        }
      }
      if (axes.empty()) {
        v_.diagnostics().add(Code::NoSharedAxis, side.relation.span, {decl_.from.front().text, decl_.to.front().text});
      }
      for (const AxisId axis : axes) {
        made_.relations.push_back({axis, *relation});
      }
    }
    only_sides();
  }

  std::optional<Relation> find_relation(const NameDecl& name) {
    if (name.text == "ipsi") {
      return Relation::Ipsi;
    }
    if (name.text == "contra") {
      return Relation::Contra;
    }
    if (name.text == "both") {
      return Relation::Both;
    }
    v_.diagnostics()
        .add(Code::UnknownWord, name.span, {"side relation", name.text})
        .help("a side is `ipsi`, `contra` or `both`");
    return std::nullopt;
  }

  [[nodiscard]] std::vector<std::string> known_sides() const {
    std::vector<std::string> known;
    for (const std::vector<Endpoint>* ends : {&made_.to, &made_.from}) {
      for (const Endpoint& end : *ends) {
        for (const AxisId axis : population(end).axes) {
          const auto& sides = v_.circuit.axes[index_of(axis)].sides;
          known.insert(known.end(), sides.begin(), sides.end());
        }
      }
    }
    return known;
  }

  void only_sides() {
    const std::vector<std::string> known = known_sides();
    for (const NameDecl& side : decl_.only_sides) {
      if (side.is_poisoned) {
        continue;
      }
      if (std::find(known.begin(), known.end(), side.text) == known.end()) {
        v_.diagnostics()
            .add(Code::UnknownSide, side.span, {decl_.to.front().text, side.text})
            .help_if(nearest_name(side.text, known), "did you mean `{}`?");
      }
      made_.only_sides.push_back(side.text);
    }
  }

  void rule() {
    if (decl_.rule.kind.is_poisoned) {
      return;  // its absence has been reported
    }
    const auto spelling = std::find_if(kRules.begin(), kRules.end(),
                                       [&](const RuleSpelling& r) { return decl_.rule.kind.text == r.text; });
    if (spelling == kRules.end()) {
      std::vector<std::string> names;
      for (const RuleSpelling& known : kRules) {
        names.emplace_back(known.text);
      }
      auto builder = v_.diagnostics().add(Code::UnknownWord, decl_.rule.kind.span, {"rule", decl_.rule.kind.text});
      const auto nearest = nearest_name(decl_.rule.kind.text, names);
      if (nearest) {
        builder.help_if(nearest, "did you mean `{}`?");
      } else {
        builder.help(fmt::format("the rules are {}", fmt::join(names, ", ")));
      }
      return;
    }
    made_.rule = spelling->kind;
    if (made_.rule == RuleKind::EdgeList) {
      edge_table();
    }
    bool has_first = spelling->arguments[0] == nullptr || std::string_view(spelling->arguments[0]) == "autapses";
    for (const KeyedValue& argument : decl_.rule.arguments) {
      const bool is_known = std::any_of(spelling->arguments.begin(), spelling->arguments.end(),
                                        [&](const char* key) { return key != nullptr && argument.key.text == key; });
      if (!is_known || argument.values.size() != 1) {
        v_.diagnostics().add(Code::UnknownKey, argument.key.span,
                             {argument.key.text, fmt::format("rule `{}`", spelling->text)});
        continue;
      }
      has_first = has_first || argument.key.text == spelling->arguments[0];
      rule_argument(argument);
    }
    if (!has_first) {
      v_.diagnostics()
          .add(Code::MissingKey, decl_.rule.kind.span,
               {fmt::format("rule `{}`", spelling->text), spelling->arguments[0]})
          .help(fmt::format("\"rule\": {{ \"kind\": \"{}\", \"{}\": {} }}", spelling->text, spelling->arguments[0],
                            made_.rule == RuleKind::FixedProbability ? "0.1" : "10"));
    }
  }

  void edge_table() {
    if (!decl_.rule.file) {
      return;  // its absence has been reported
    }
    EdgeTableReader reader(v_, decl_.rule);
    made_.edges = reader.read();
    if (!made_.edges) {
      is_sound_ = false;
      return;
    }
    if (!find_cell_tables()) {
      is_sound_ = false;
      return;
    }
    const std::uint32_t first = kFirstAxisVariable + 3 * static_cast<std::uint32_t>(v_.circuit.axes.size());
    const auto count = static_cast<std::uint32_t>(reader.variables().size());
    for (std::uint32_t c = 0; c < count; ++c) {
      names_.add_variable("edge." + reader.variables()[c], kNumber, first + c);
      if (made_.edges->names_cells) {
        names_.add_variable("pre.sum." + reader.variables()[c], kNumber, first + count + c);
        names_.add_variable("post.sum." + reader.variables()[c], kNumber, first + 2 * count + c);
      }
    }
  }

  /// Where both ends are cells of tables, the file names them; where neither is, it numbers them.
  bool find_cell_tables() {
    if (made_.from.empty() || made_.to.empty()) {
      return true;
    }
    const auto pre = population(made_.from.front()).cell_table;
    const auto post = population(made_.to.front()).cell_table;
    const auto differs = [&](const std::vector<Endpoint>& ends, std::optional<std::uint32_t> table) {
      return std::any_of(ends.begin(), ends.end(),
                         [&](const Endpoint& end) { return population(end).cell_table != table; });
    };
    if (pre.has_value() != post.has_value() || differs(made_.from, pre) || differs(made_.to, post)) {
      v_.diagnostics()
          .add(Code::BadEdgeList, made_.edges->span,
               {"the populations of this edge list are not all cells, of one table at each end"})
          .help("write one projection for those that the file names and one for those that it numbers");
      return false;
    }
    made_.edges->names_cells = pre.has_value();
    made_.edges->pre_table = pre.value_or(0);
    made_.edges->post_table = post.value_or(0);
    return true;
  }

  void rule_argument(const KeyedValue& argument) {
    const ValueDecl& value = argument.values.front();
    if (argument.key.text == "autapses") {
      made_.allows_autapses = v_.scope.constant(value, "autapses", kBoolean).value_or(0) != 0;
    } else if (argument.key.text == "first_index") {
      if (made_.edges) {
        made_.edges->first_index = v_.scope.whole(value, "first_index", 0, 0xFFFFFFFFU).value_or(0);
      }
    } else if (argument.key.text == "n") {
      made_.degree = static_cast<std::uint32_t>(v_.scope.whole(value, "n", 1, 0xFFFFFFFFU).value_or(1));
      degree_span_ = value.span;
    } else if (is_sound_) {
      made_.probability = v_.scope.expression(value, names_, "p", kNumber);
      if (made_.probability && made_.probability->constant) {
        const double p = *made_.probability->constant;
        if (!(p >= 0 && p <= 1)) {
          v_.diagnostics().add(Code::OutOfRange, value.span, {"p", shown(p, kNumber), "0 to 1"});
        }
      }
    }
  }

  [[nodiscard]] bool has_fields(const std::vector<Endpoint>& ends) const {
    return std::all_of(ends.begin(), ends.end(),
                       [&](const Endpoint& e) { return population(e).model == ModelKind::FieldSource; });
  }

  /// True for the axes whose sides a visual field has: left and right, up and down.
  static bool is_spatial(const Axis& axis) {
    return std::all_of(axis.sides.begin(), axis.sides.end(), [](const std::string& side) {
      return side == "left" || side == "right" || side == "up" || side == "down";
    });
  }

  void make_environment() {
    names_.outer = &v_.scope.environment;
    names_.add_variable("pre.index", kNumber, kPreIndex);
    names_.add_variable("post.index", kNumber, kPostIndex);
    names_.add_variable("pre.size", kNumber, kPreSize);
    names_.add_variable("post.size", kNumber, kPostSize);
    names_.add_variable("pre.pos", kNumber, kPrePosition);
    names_.add_variable("post.pos", kNumber, kPostPosition);
    names_.add_variable("random", kNumber, kPairRandom);
    place_names();
  }

  /// The dimension in which all of these populations have positions, if they do.
  [[nodiscard]] std::optional<Dimension> position_dimension(const std::vector<Endpoint>& ends) const {
    std::optional<Dimension> common = population(ends.front()).position_dimension;
    for (const Endpoint& end : ends) {
      common = population(end).position_dimension == common ? common : std::nullopt;
    }
    return common;
  }

  void place_names() {
    const auto pre = position_dimension(made_.from);
    const auto post = position_dimension(made_.to);
    if (pre) {
      names_.add_variable("pre.x", *pre, kPreX);
      names_.add_variable("pre.y", *pre, kPreY);
      names_.add_variable("x", *pre, kPreX);
      names_.add_variable("y", *pre, kPreY);
    }
    if (post) {
      names_.add_variable("post.x", *post, kPostX);
      names_.add_variable("post.y", *post, kPostY);
    }
    if (pre && pre == post) {
      names_.add_variable("distance", *pre, kDistance);
    }
    const bool pre_has_fields = has_fields(made_.from);
    if (pre_has_fields) {
      names_.add_variable("pre.ecc", kAngle, kPreEccentricity);
      names_.add_variable("ecc", kAngle, kPreEccentricity);
    }
    side_names(pre == kAngle);
    explain_absent_names();
  }

  /// What the names of geometry would need, for those that mean nothing here.
  void explain_absent_names() {
    const std::string& from = population(made_.from.front()).name;
    const std::string& to = population(made_.to.front()).name;
    v_.scope.absent = {
        {"ecc", fmt::format("`ecc` needs a retina population as the source, `{}` is none", from)},
        {"pre.ecc", fmt::format("`pre.ecc` needs a retina population as the source, `{}` is none", from)},
        {"x", fmt::format("`x` needs a source with positions, `{}` has none", from)},
        {"y", fmt::format("`y` needs a source with positions, `{}` has none", from)},
        {"pre.x", fmt::format("`pre.x` needs a source with positions, `{}` has none", from)},
        {"pre.y", fmt::format("`pre.y` needs a source with positions, `{}` has none", from)},
        {"post.x", fmt::format("`post.x` needs a target with positions, `{}` has none", to)},
        {"post.y", fmt::format("`post.y` needs a target with positions, `{}` has none", to)},
        {"distance", fmt::format("`distance` needs positions of one dimension at both ends, `{}` and `{}`", from, to)},
        {"hemifield",
         fmt::format("`hemifield` needs a source in the visual field and one axis of left/right or up/down "
                     "on the target, `{}` and `{}`",
                     from, to)},
        {"side", fmt::format("`side` needs one axis on the target or the source, `{}` and `{}`", to, from)},
    };
  }

  void side_names(bool pre_has_angles) {
    std::vector<AxisId> post_axes = population(made_.to.front()).axes;
    std::vector<AxisId> pre_axes = population(made_.from.front()).axes;
    std::vector<AxisId> spatial;
    for (std::uint32_t a = 0; a < v_.circuit.axes.size(); ++a) {
      const auto id = static_cast<AxisId>(a);
      const Axis& axis = v_.circuit.axes[a];
      const std::uint32_t slot = kFirstAxisVariable + 3 * a;
      const bool pre_has = std::find(pre_axes.begin(), pre_axes.end(), id) != pre_axes.end();
      const bool post_has = std::find(post_axes.begin(), post_axes.end(), id) != post_axes.end();
      if (pre_has) {
        names_.add_variable("pre.side." + axis.name, kWord, slot);
      }
      if (post_has) {
        names_.add_variable("post.side." + axis.name, kWord, slot + 1);
      }
      if (pre_has || post_has) {
        names_.add_variable("side." + axis.name, kWord, slot + (post_has ? 1 : 0));
      }
      if (pre_has_angles && is_spatial(axis)) {
        names_.add_variable("hemifield." + axis.name, kWord, slot + 2);
        if (post_has) {
          spatial.push_back(id);
        }
      }
    }
    // The short names, where only one axis can be meant.
    if (spatial.size() == 1) {
      const std::uint32_t slot = kFirstAxisVariable + 3 * static_cast<std::uint32_t>(spatial.front());
      names_.add_variable("hemifield", kWord, slot + 2);
      names_.add_variable("side", kWord, slot + 1);
    } else if (post_axes.size() == 1) {
      names_.add_variable("side", kWord, kFirstAxisVariable + 3 * static_cast<std::uint32_t>(post_axes.front()) + 1);
    } else if (post_axes.empty() && pre_axes.size() == 1) {
      names_.add_variable("side", kWord, kFirstAxisVariable + 3 * static_cast<std::uint32_t>(pre_axes.front()));
    }
  }

  void receptors() {
    for (std::size_t i = 0; i < made_.to.size(); ++i) {
      Endpoint& to = made_.to[i];
      const Population& target = population(to);
      const NameDecl& name = decl_.to[i];
      if (target.receptors.empty()) {
        v_.diagnostics().add(Code::NoReceptor, name.span, {target.name, std::string(model_of(target).name)});
        is_sound_ = false;
        continue;
      }
      const std::string wanted = decl_.receptor ? decl_.receptor->text : made_.is_inhibitory ? "in" : "ex";
      const auto found = std::find_if(target.receptors.begin(), target.receptors.end(),
                                      [&](const Receptor& r) { return r.name == wanted; });
      if (found != target.receptors.end()) {
        to.receptor = static_cast<std::uint32_t>(found - target.receptors.begin());
      } else if (!decl_.receptor && target.receptors.size() == 1) {
        to.receptor = 0;
      } else {
        report_receptor(target, name, wanted);
      }
    }
  }

  void report_receptor(const Population& target, const NameDecl& name, const std::string& wanted) {
    std::vector<std::string> names;
    for (const Receptor& receptor : target.receptors) {
      names.push_back(receptor.name);
    }
    if (decl_.receptor) {
      v_.diagnostics()
          .add(Code::UnknownReceptor, decl_.receptor->span, {target.name, wanted})
          .help(fmt::format("it has {}", fmt::join(names, ", ")));
    } else {
      v_.diagnostics()
          .add(Code::AmbiguousReceptor, name.span,
               {target.name, fmt::format("{}", fmt::join(names, ", ")),
                made_.is_inhibitory ? "inhibitory" : "excitatory"})
          .help("say which with `receptor`");
    }
  }

  [[nodiscard]] Unit weight_unit(const Endpoint& to) const {
    const Population& target = population(to);
    if (target.user_model) {
      return {target.user_model->equations.inputs[to.receptor].dimension, 0, 1};
    }
    return parse_unit(find_model(target.model)->weight_unit).value_or(Unit{});
  }

  void weight() {
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

  std::optional<TypedExpression> weight_of(const ValueDecl& value, const Unit& unit) {
    auto typed = v_.scope.expression(value, names_, "weight", unit.dimension);
    if (typed && typed->constant && *typed->constant < 0) {
      v_.diagnostics()
          .add(Code::NegativeWeight, value.span, {shown(*typed->constant, unit.dimension)})
          .help("write `\"sign\": \"inhibitory\"` and the weight without its minus");
    }
    return typed;
  }

  /// Weights and delays that hold on one side only.
  void exceptions(const Unit& unit) {
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

  void delay() {
    if (!decl_.delay) {
      return;
    }
    made_.delay_span = decl_.delay->span;
    if (auto typed = delay_of(*decl_.delay)) {
      made_.delay = std::move(*typed);
    }
  }

  std::optional<TypedExpression> delay_of(const ValueDecl& value) {
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

  void where() {
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

  void check_degree() {
    const bool is_in_degree = made_.rule == RuleKind::FixedInDegree;
    for (const Endpoint& from : made_.from) {
      for (const Endpoint& to : made_.to) {
        const Population& partner = population(is_in_degree ? from : to);
        const bool is_recurrent = from.population == to.population && !made_.allows_autapses;
        const std::uint32_t offered = partner.size - (is_recurrent ? 1 : 0);
        if (made_.degree > offered) {
          v_.diagnostics().add(Code::DegreeTooLarge, *degree_span_,
                               {fmt::format("{}", made_.degree), fmt::format("{}", offered), partner.name});
          return;
        }
      }
    }
  }

  void check_sizes() {
    for (const Endpoint& from : made_.from) {
      for (std::size_t i = 0; i < made_.to.size(); ++i) {
        const Population& pre = population(from);
        const Population& post = population(made_.to[i]);
        if (pre.size != post.size) {
          v_.diagnostics()
              .add(Code::SizesDiffer, decl_.to[i].span,
                   {pre.name, fmt::format("{}", pre.size), post.name, fmt::format("{}", post.size)})
              .help("all_to_all joins populations of any size");
          return;
        }
      }
    }
  }

  Validation& v_;
  const ProjectionDecl& decl_;
  Projection& made_;
  Environment names_;
  std::optional<Span> degree_span_;
  bool is_sound_ = true;
};

}  // namespace

void validate_projections(Validation& v) {
  for (const ProjectionDecl& decl : v.decl.projections) {
    ProjectionValidator(v, decl, v.circuit.projections.emplace_back()).run();
  }
}

}  // namespace tectum
