#include "tools/diff/diff_json.h"

#include <nlohmann/json.hpp>

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

const char* kind_name(LinkKind kind) {
  constexpr std::array<const char*, 4> kNames = {"field", "spike", "potential", "command"};
  return kNames[static_cast<std::size_t>(kind)];
}

Json changes_json(const StructureDiff& structure) {
  Json changes = Json::array();
  for (const Change& change : structure.changes) {
    changes.push_back({{"kind", change_name(change.kind)},
                       {"element", element_name(change.element)},
                       {"name", change.name},
                       {"where", change.where},
                       {"property", change.property},
                       {"before", change.before},
                       {"after", change.after},
                       {"detail", change.detail},
                       {"group", change.group},
                       {"place", change.place},
                       {"because", change.because}});
  }
  return changes;
}

Json divergence_json(const Divergence& divergence) {
  Json links = Json::array();
  for (const DivergenceLink& link : divergence.links) {
    links.push_back({{"kind", kind_name(link.kind)},
                     {"what", link.what},
                     {"population", link.population},
                     {"time_ms", link.time_ms},
                     {"how", link.how},
                     {"others", link.others},
                     {"why", link.why},
                     {"from", link.from},
                     {"changes", link.changes}});
  }
  return links;
}

Json kinematics_json(const Behaviour& behaviour) {
  Json figures = Json::array();
  for (const PairedFigure& figure : behaviour.kinematics) {
    Json seeds = Json::array();
    for (std::size_t s = 0; s < figure.a.size(); ++s) {
      seeds.push_back({figure.a[s], figure.b[s]});
    }
    const bool is_known = !figure.a.empty();
    figures.push_back({{"name", figure.name},
                       {"unit", figure.unit},
                       {"first", is_known ? Json(figure.mean_a()) : Json(nullptr)},
                       {"second", is_known ? Json(figure.mean_b()) : Json(nullptr)},
                       {"change", is_known ? Json(figure.difference()) : Json(nullptr)},
                       {"spread", figure.a.size() > 1 ? Json(figure.spread()) : Json(nullptr)},
                       {"beyond_spread", or_null(figure.exceeds_spread())},
                       {"by_seed", std::move(seeds)}});
  }
  return figures;
}

Json populations_json(const Behaviour& behaviour) {
  Json populations = Json::array();
  for (const PopulationDifference& p : behaviour.populations) {
    const bool has_latency = !p.latency.a.empty();
    populations.push_back({{"name", p.name},
                           {"first_hz", p.rate.mean_a()},
                           {"second_hz", p.rate.mean_b()},
                           {"change_hz", p.rate.difference()},
                           {"spread_hz", p.rate.a.size() > 1 ? Json(p.rate.spread()) : Json(nullptr)},
                           {"beyond_spread", or_null(p.rate.exceeds_spread())},
                           {"first_latency_ms", has_latency ? Json(p.latency.mean_a()) : Json(nullptr)},
                           {"second_latency_ms", has_latency ? Json(p.latency.mean_b()) : Json(nullptr)},
                           {"latency_change_ms", has_latency ? Json(p.latency.difference()) : Json(nullptr)},
                           {"latency_spread_ms", p.latency.a.size() > 1 ? Json(p.latency.spread()) : Json(nullptr)},
                           {"latency_beyond_spread", or_null(p.latency.exceeds_spread())},
                           {"lag_ms", or_null(p.lag_ms)},
                           {"van_rossum", p.van_rossum},
                           {"victor_purpura", p.victor_purpura},
                           {"spike", p.spike}});
  }
  return populations;
}

}  // namespace

std::string diff_json(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                      const Behaviour* behaviour) {
  Json json;
  json["first"] = a.path;
  json["second"] = b.path;
  json["same"] = structure.is_same() && (behaviour == nullptr || behaviour->is_same);
  json["changes"] = changes_json(structure);
  if (behaviour != nullptr) {
    json["behaviour"] = {{"same", behaviour->is_same},
                         {"closed_loop", behaviour->is_closed_loop},
                         {"what", behaviour->what},
                         {"divergence", divergence_json(behaviour->divergence)},
                         {"kinematics", kinematics_json(*behaviour)},
                         {"populations", populations_json(*behaviour)}};
  }
  return json.dump(2);
}

}  // namespace tectum
