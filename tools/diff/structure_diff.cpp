#include "tools/diff/structure_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "tools/diff/ports_diff.h"

namespace tectum {
namespace {

using Projections = std::vector<std::set<std::string>>;  // that touch each population, as "name<" or "name>"

Projections roles_of(const CircuitView& view) {
  Projections roles(view.populations.size());
  for (const PathwayView& pathway : view.pathways) {
    roles[pathway.pre_population].insert(pathway.projection + ">");
    roles[pathway.post_population].insert(pathway.projection + "<");
  }
  return roles;
}

/// By name; what is left is paired when size, model, side and most projections agree: a population renamed.
void match_populations(const CircuitView& a, const CircuitView& b, Correspondence& match) {
  match.population_of_a.assign(a.populations.size(), kNoMatch);
  match.population_of_b.assign(b.populations.size(), kNoMatch);
  const auto pair = [&](std::uint32_t i, std::uint32_t j) {
    match.population_of_a[i] = j;
    match.population_of_b[j] = i;
  };
  std::map<std::string, std::uint32_t> by_name;
  for (std::uint32_t j = 0; j < b.populations.size(); ++j) {
    by_name[b.populations[j].name] = j;
  }
  for (std::uint32_t i = 0; i < a.populations.size(); ++i) {
    if (const auto found = by_name.find(a.populations[i].name); found != by_name.end()) {
      pair(i, found->second);
    }
  }
  const Projections roles_a = roles_of(a), roles_b = roles_of(b);
  for (std::uint32_t i = 0; i < a.populations.size(); ++i) {
    if (match.population_of_a[i] != kNoMatch) {
      continue;
    }
    std::size_t best = 0;
    std::uint32_t partner = kNoMatch;
    for (std::uint32_t j = 0; j < b.populations.size(); ++j) {
      const PopulationView &left = a.populations[i], &right = b.populations[j];
      if (match.population_of_b[j] != kNoMatch || left.size != right.size || left.model != right.model ||
          sided_name(left.name).side != sided_name(right.name).side) {
        continue;
      }
      const auto common = static_cast<std::size_t>(std::count_if(
          roles_a[i].begin(), roles_a[i].end(), [&](const std::string& role) { return roles_b[j].contains(role); }));
      const std::size_t score = 1 + common;
      if (2 * common >= roles_a[i].size() && score > best) {
        best = score;
        partner = j;
      }
    }
    if (partner != kNoMatch) {
      pair(i, partner);
    }
  }
}

std::string values_text(const ParameterView& parameter) {
  if (parameter.values.size() == 1) {
    return quantity_text(parameter.values[0], parameter.unit);
  }
  const auto [low, high] = std::minmax_element(parameter.values.begin(), parameter.values.end());
  return fmt::format("{} to {}", quantity_text(*low, ""), quantity_text(*high, parameter.unit));
}

bool same_values(const ParameterView& a, const ParameterView& b, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    if (a.of(i) != b.of(i)) {
      return false;
    }
    if (a.values.size() == 1 && b.values.size() == 1) {
      break;
    }
  }
  return true;
}

class StructureDiffer {
 public:
  StructureDiffer(const CircuitView& a, const CircuitView& b) : a_(a), b_(b) {}

  StructureDiff run() {
    match_populations(a_, b_, diff_.match);
    circuit();
    parameters();
    populations();
    pathways();
    std::vector<Change> ports = diff_ports(a_, b_, diff_.match);
    diff_.changes.insert(diff_.changes.end(), ports.begin(), ports.end());
    attribute_to_parameters();
    return std::move(diff_);
  }

 private:
  Change& add(Change change) {
    diff_.changes.push_back(std::move(change));
    return diff_.changes.back();
  }
  void changed(Element element, const std::string& name, const std::string& property, const std::string& before,
               const std::string& after, const std::string& group = "") {
    if (before != after) {
      Change change;
      change.element = element;
      change.name = name;
      change.property = property;
      change.before = before;
      change.after = after;
      change.group = group;
      add(std::move(change));
    }
  }
  void came_or_went(ChangeKind kind, Element element, const std::string& name, const std::string& detail,
                    const std::string& group = "", const std::string& where = "") {
    Change change;
    change.kind = kind;
    change.element = element;
    change.name = name;
    change.detail = detail;
    change.group = group;
    change.where = where;
    add(std::move(change));
  }

  void circuit() {
    const auto tick = [](const CircuitView& view) { return quantity_text(view.tick_ms(), "ms"); };
    changed(Element::Circuit, "circuit", "tick", tick(a_), tick(b_));
    changed(Element::Circuit, "circuit", "seed", std::to_string(a_.image.header.seed),
            std::to_string(b_.image.header.seed));
  }

  void parameters() {
    for (const auto& [name, written] : a_.parameters) {
      const auto other = b_.parameters.find(name);
      if (other == b_.parameters.end()) {
        came_or_went(ChangeKind::Removed, Element::Parameter, name, written.text);
      } else if (other->second.text != written.text) {
        changed(Element::Parameter, name, "value", written.text, other->second.text);
        diff_.changes.back().place = other->second.place;
      }
    }
    for (const auto& [name, written] : b_.parameters) {
      if (!a_.parameters.empty() && !a_.parameters.contains(name)) {
        came_or_went(ChangeKind::Added, Element::Parameter, name, written.text);
        diff_.changes.back().place = written.place;
      }
    }
  }

  void populations() {
    const auto what = [](const PopulationView& p) { return fmt::format("{} neurons, {}", p.size, p.model); };
    for (std::uint32_t i = 0; i < a_.populations.size(); ++i) {
      const PopulationView& population = a_.populations[i];
      if (const std::uint32_t j = diff_.match.population_of_a[i]; j == kNoMatch) {
        came_or_went(ChangeKind::Removed, Element::Population, population.name, what(population), population.nucleus);
      } else {
        population_pair(population, b_.populations[j]);
      }
    }
    for (std::uint32_t j = 0; j < b_.populations.size(); ++j) {
      if (diff_.match.population_of_b[j] == kNoMatch) {
        const PopulationView& population = b_.populations[j];
        came_or_went(ChangeKind::Added, Element::Population, population.name, what(population), population.nucleus);
      }
    }
  }

  void population_pair(const PopulationView& a, const PopulationView& b) {
    const std::string& group = a.nucleus;
    const auto property = [&](const std::string& name, const std::string& before, const std::string& after) {
      changed(Element::Population, b.name, name, before, after, group);
    };
    if (a.name != b.name) {
      Change change;
      change.kind = ChangeKind::Renamed;
      change.element = Element::Population;
      change.name = b.name;
      change.before = a.name;
      change.after = b.name;
      change.group = group;
      add(std::move(change));
    }
    property("size", std::to_string(a.size), std::to_string(b.size));
    property("nucleus", a.nucleus, b.nucleus);
    if (a.silenced != b.silenced) {
      property("silenced neurons", std::to_string(a.silenced.size()), std::to_string(b.silenced.size()));
      if (a.silenced.size() == b.silenced.size()) {
        property("silenced neurons", "some", "others");
      }
    }
    if (a.model != b.model) {
      if (a.model != "silenced" && b.model != "silenced") {
        property("model", a.model, b.model);
      }
      return;
    }
    const std::size_t size = std::min(a.size, b.size);
    for (std::size_t p = 0; p < std::min(a.parameters.size(), b.parameters.size()); ++p) {
      const ParameterView &left = a.parameters[p], &right = b.parameters[p];
      if (!same_values(left, right, size)) {
        const std::string before = values_text(left), after = values_text(right);
        property(left.name, before, before == after ? "other values in the same range" : after);
      }
    }
    if (a.words != b.words) {
      property(a.model == "spike_list" ? "times" : "equations", "some", "others");
    }
    receptors(a, b);
  }

  void receptors(const PopulationView& a, const PopulationView& b) {
    const auto text = [&](const ReceptorView& receptor) {
      return receptor.kind == ReceptorKind::Exponential ? "tau " + quantity_text(receptor.tau_ms, "ms")
             : receptor.kind == ReceptorKind::Boxcar    ? fmt::format("a window of {} ticks", receptor.window_ticks)
                                                        : std::string("instantaneous");
    };
    std::map<std::string, std::pair<std::string, std::string>> both;
    for (const ReceptorView& receptor : a.receptors) {
      both[receptor.name].first = text(receptor);
    }
    for (const ReceptorView& receptor : b.receptors) {
      both[receptor.name].second = text(receptor);
    }
    for (const auto& [name, pair] : both) {
      const auto shown = [](const std::string& value) { return value.empty() ? "none" : value; };
      changed(Element::Population, b.name, "receptor " + name, shown(pair.first), shown(pair.second), a.nucleus);
    }
  }

  using Key = std::tuple<std::string, std::uint32_t, std::uint32_t, std::string>;  // in b's populations
  Key key_of(const CircuitView& view, const PathwayView& pathway, bool is_a) const {
    const auto there = [&](std::uint32_t population) {
      const std::uint32_t other = is_a ? diff_.match.population_of_a[population] : population;
      // An unmatched population of a must not be taken for one of b's.
      return is_a && other == kNoMatch ? static_cast<std::uint32_t>(b_.populations.size()) + population : other;
    };
    return {pathway.projection, there(pathway.pre_population), there(pathway.post_population),
            view.populations[pathway.post_population].receptors[pathway.receptor].name};
  }
  static std::string where_of(const CircuitView& view, const PathwayView& pathway) {
    return view.populations[pathway.pre_population].name + " -> " + view.populations[pathway.post_population].name;
  }

  void pathways() {
    std::map<Key, std::uint32_t> in_b;
    std::vector<bool> is_taken(b_.pathways.size(), false);
    for (std::uint32_t j = 0; j < b_.pathways.size(); ++j) {
      in_b[key_of(b_, b_.pathways[j], false)] = j;
    }
    std::vector<std::uint32_t> lonely;
    for (std::uint32_t i = 0; i < a_.pathways.size(); ++i) {
      const auto found = in_b.find(key_of(a_, a_.pathways[i], true));
      if (found == in_b.end()) {
        lonely.push_back(i);
        continue;
      }
      is_taken[found->second] = true;
      diff_.match.pathways.push_back({i, found->second, compare(a_.pathways[i], b_.pathways[found->second])});
    }
    for (const std::uint32_t i : lonely) {
      rewired_or_removed(i, is_taken);
    }
    for (std::uint32_t j = 0; j < b_.pathways.size(); ++j) {
      if (!is_taken[j]) {
        diff_.match.pathways.push_back({kNoMatch, j, true});
        came_or_went(ChangeKind::Added, Element::Projection, b_.pathways[j].projection,
                     fmt::format("{} synapses", b_.pathways[j].synapses.size()), group_of(b_, b_.pathways[j]),
                     where_of(b_, b_.pathways[j]));
      }
    }
  }

  static std::string group_of(const CircuitView& view, const PathwayView& pathway) {
    return view.populations[pathway.post_population].nucleus;
  }

  /// The same projection elsewhere (another side, another receptor), a projection of another name, or none.
  void rewired_or_removed(std::uint32_t i, std::vector<bool>& is_taken) {
    const PathwayView& old = a_.pathways[i];
    const Key key = key_of(a_, old, true);
    for (std::uint32_t j = 0; j < b_.pathways.size(); ++j) {
      const PathwayView& now = b_.pathways[j];
      const Key other = key_of(b_, now, false);
      const bool same_ends = std::get<1>(key) == std::get<1>(other) && std::get<2>(key) == std::get<2>(other);
      if (is_taken[j] || !same_ends) {
        continue;
      }
      const bool other_receptor = std::get<0>(key) == std::get<0>(other);
      const bool other_name = std::get<3>(key) == std::get<3>(other) && old.synapses.size() == now.synapses.size();
      if (other_receptor || other_name) {
        is_taken[j] = true;
        if (other_receptor) {
          changed(Element::Projection, now.projection, "receptor", std::get<3>(key), std::get<3>(other),
                  group_of(b_, now));
          diff_.changes.back().where = where_of(b_, now);
        } else {
          came_or_went(ChangeKind::Renamed, Element::Projection, now.projection, "", group_of(b_, now),
                       where_of(b_, now));
          diff_.changes.back().before = old.projection;
          diff_.changes.back().after = now.projection;
        }
        diff_.match.pathways.push_back({i, j, compare(old, now) || other_receptor});
        return;
      }
    }
    diff_.match.pathways.push_back({i, kNoMatch, true});
    came_or_went(ChangeKind::Removed, Element::Projection, old.projection,
                 fmt::format("{} synapses", old.synapses.size()), group_of(a_, old), where_of(a_, old));
  }

  /// Adds what differs; true when anything does.
  bool compare(const PathwayView& a, const PathwayView& b) {
    const PopulationView& post_a = a_.populations[a.post_population];
    const PopulationView& post_b = b_.populations[b.post_population];
    const int quantum_a = post_a.receptors[a.receptor].quantum_log2;
    const int quantum_b = post_b.receptors[b.receptor].quantum_log2;
    std::size_t weights = 0, delays = 0, gone = 0, come = 0, i = 0, j = 0;
    const SynapseView *w_a = nullptr, *w_b = nullptr, *d_a = nullptr, *d_b = nullptr;
    while (i < a.synapses.size() || j < b.synapses.size()) {
      const SynapseView* x = i < a.synapses.size() ? &a.synapses[i] : nullptr;
      const SynapseView* y = j < b.synapses.size() ? &b.synapses[j] : nullptr;
      if (y == nullptr || (x != nullptr && std::tie(x->pre, x->post) < std::tie(y->pre, y->post))) {
        ++gone, ++i;
      } else if (x == nullptr || std::tie(y->pre, y->post) < std::tie(x->pre, x->post)) {
        ++come, ++j;
      } else {
        if (!is_same_weight(x->weight, quantum_a, y->weight, quantum_b)) {
          w_a = w_a == nullptr ? x : w_a, w_b = w_b == nullptr ? y : w_b, ++weights;
        }
        if (x->delay_ticks != y->delay_ticks) {
          d_a = d_a == nullptr ? x : d_a, d_b = d_b == nullptr ? y : d_b, ++delays;
        }
        ++i, ++j;
      }
    }
    const std::string place_end = group_of(b_, b), where = where_of(b_, b);
    const auto note = [&](const std::string& property, const std::string& before, const std::string& after,
                          std::size_t count, const std::map<std::string, WrittenValue>& texts) {
      Change change;
      change.element = Element::Projection;
      change.name = b.projection;
      change.where = where;
      change.property = property;
      change.before = before;
      change.after = after;
      change.detail = fmt::format("{} of {} synapses", count, b.synapses.size());
      change.group = place_end;
      if (const auto text = texts.find(b.projection); text != texts.end()) {
        change.place = text->second.place;
      }
      add(std::move(change));
    };
    if (weights > 0) {
      note("weight", quantity_text(w_a->weight, post_a.weight_unit), quantity_text(w_b->weight, post_b.weight_unit),
           weights, b_.weight_text);
    }
    if (delays > 0) {
      note("delay", quantity_text(d_a->delay_ticks * a_.tick_ms(), "ms"),
           quantity_text(d_b->delay_ticks * b_.tick_ms(), "ms"), delays, b_.delay_text);
    }
    if (gone + come > 0) {
      note("synapses", std::to_string(a.synapses.size()), std::to_string(b.synapses.size()), gone + come, {});
    }
    return weights + delays + gone + come > 0;
  }

  /// Parameters whose text changed, or that use one that did, and that `text` names.
  std::string cause_in(const std::string& text, int depth = 0) const {
    for (std::size_t begin = 0; begin < text.size() && depth < 8;) {
      const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
      std::size_t end = begin;
      while (end < text.size() && is_word(text[end])) {
        ++end;
      }
      const auto written = b_.parameters.find(text.substr(begin, end - begin));
      if (end > begin && written != b_.parameters.end()) {
        const auto old = a_.parameters.find(written->first);
        if (old != a_.parameters.end() && old->second.text != written->second.text) {
          return fmt::format("{} is {} instead of {}", written->first, written->second.text, old->second.text);
        }
        if (std::string deeper = cause_in(written->second.text, depth + 1); !deeper.empty()) {
          return deeper;
        }
      }
      begin = std::max(end, begin + 1);
    }
    return "";
  }
  void attribute_to_parameters() {
    for (Change& change : diff_.changes) {
      if (change.element != Element::Projection || change.kind != ChangeKind::Changed) {
        continue;
      }
      const auto& texts = change.property == "weight" ? b_.weight_text : b_.delay_text;
      const auto& olds = change.property == "weight" ? a_.weight_text : a_.delay_text;
      const auto text = texts.find(change.name);
      const auto old = olds.find(change.name);
      if (text != texts.end() && old != olds.end() && text->second.text == old->second.text) {
        change.because = cause_in(text->second.text);
      }
    }
  }

  const CircuitView& a_;
  const CircuitView& b_;
  StructureDiff diff_;
};

}  // namespace

const char* element_name(Element element) {
  constexpr std::array<const char*, 7> kNames = {"circuit", "parameter", "population", "projection",
                                                 "retina",  "output",    "joint"};
  return kNames[static_cast<std::size_t>(element)];
}

const char* change_name(ChangeKind kind) {
  constexpr std::array<const char*, 4> kNames = {"added", "removed", "renamed", "changed"};
  return kNames[static_cast<std::size_t>(kind)];
}

bool is_same_weight(double a, int quantum_log2_a, double b, int quantum_log2_b) {
  return std::abs(a - b) <= std::ldexp(1.0, std::max(quantum_log2_a, quantum_log2_b));
}

std::string quantity_text(double value, const std::string& unit) {
  return fmt::format("{:.6g}{}{}", value, unit.empty() ? "" : " ", unit);
}

StructureDiff diff_structure(const CircuitView& a, const CircuitView& b) { return StructureDiffer(a, b).run(); }

}  // namespace tectum
