#include "tools/exchange/circuit_rest.h"

#include <algorithm>

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const JsonTree& tree, JsonId id) {
  const JsonNode& node = tree[id];
  Json made;
  switch (node.kind) {
    case JsonKind::Null:
      return nullptr;
    case JsonKind::Boolean:
      return node.boolean;
    case JsonKind::Number:
      return Json::parse(node.text, nullptr, false);
    case JsonKind::String:
      return node.text;
    case JsonKind::Array:
      made = Json::array();
      for (JsonId child = node.first_child; child != JsonId::None; child = tree[child].next_sibling) {
        made.push_back(json_of(tree, child));
      }
      return made;
    case JsonKind::Object:
      made = Json::object();
      for (JsonId child = node.first_child; child != JsonId::None; child = tree[child].next_sibling) {
        made[tree[child].key] = json_of(tree, child);
      }
      return made;
  }
  return made;
}

/// Members of the circuit file, after `include` and `extends`.
void copy_members(const JsonTree& tree, Json& rest) {
  for (const char* key : {"name", "about", "tick", "references", "axes", "models", "inputs", "outputs", "joints"}) {
    const JsonId id = tree.find(tree.root(), key);
    if (id != JsonId::None) {
      rest[key] = json_of(tree, id);
    }
  }
}

/// As they hold after -p.
void add_parameters(const CircuitDecl& decl, Json& rest) {
  for (const ParameterDecl& parameter : decl.parameters) {
    const ValueDecl& value = parameter.value;
    rest["parameters"][parameter.name.text] = value.is_number ? Json(value.number) : Json(value.text);
  }
}

Json inputs_of(const Circuit& circuit, const Population& population) {
  Json by_side = Json::object();
  std::string first;
  bool is_one = true;
  for (std::uint32_t i = 0; i < population.instance_count; ++i) {
    const Instance& instance = circuit.instances[index_of(population.first_instance) + i];
    const std::string& retina = circuit.retinas[index_of(*instance.retina)].name;
    first = i == 0 ? retina : first;
    is_one = is_one && retina == first;
    if (!instance.sides.empty()) {
      by_side[circuit.axes[index_of(population.axes.front())].sides[instance.sides.front()]] = retina;
    }
  }
  return is_one ? Json(first) : by_side;
}

}  // namespace

nlohmann::ordered_json circuit_rest(const CompileResult& result) {
  const Circuit& circuit = *result.circuit;
  Json rest;
  rest["tectum"] = 1;
  copy_members(*result.tree, rest);
  rest["seed"] = circuit.seed;
  add_parameters(*result.decl, rest);
  Json populations = Json::object();
  for (const Population& population : circuit.populations) {
    Json said = Json::object();
    for (const AxisId axis : population.axes) {
      said["axis"].push_back(circuit.axes[index_of(axis)].name);
    }
    if (!population.nucleus.empty()) {
      said["nucleus"] = population.nucleus;
    }
    const auto declared = std::find_if(result.decl->populations.begin(), result.decl->populations.end(),
                                       [&](const PopulationDecl& p) { return p.name.text == population.name; });
    if (declared != result.decl->populations.end() && !declared->mixed_signs.empty()) {
      said["mixed_signs"] = declared->mixed_signs;
    }
    if (circuit.instances[index_of(population.first_instance)].retina) {
      said["input"] = inputs_of(circuit, population);
    }
    populations[population.name] = std::move(said);
  }
  rest["populations"] = std::move(populations);
  for (const NetworkPopulation& population : result.network->populations) {
    if (population.silenced_neurons.size() == population.size) {
      rest["silenced"].push_back(population.name);
    }
  }
  return rest;
}

}  // namespace tectum
