#include "tools/exchange/foreign_circuit.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "compiler/format/format_circuit.h"
#include "tools/exchange/text_file.h"

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

/// When this is the side: "side == left", or "side.horizontal == left && side.vertical == up".
std::string condition_of(const ForeignPopulation& population, const ForeignSide& side) {
  std::string text;
  for (std::size_t a = 0; a < side.sides.size(); ++a) {
    text += (a == 0 ? "" : " && ") + (side.sides.size() == 1
                                          ? "side == " + side.sides[a]
                                          : fmt::format("side.{} == {}", population.axes[a], side.sides[a]));
  }
  return text;
}

/// Neuron i's value on every side, as one expression.
std::string value_text(const ForeignPopulation& population, const std::string& name, std::size_t neuron) {
  std::vector<std::string> texts;
  for (const ForeignSide& side : population.sides) {
    const ForeignValue& value = side.parameters.at(name);
    texts.push_back(quantity_text(value.numbers[value.numbers.size() == 1 ? 0 : neuron], value.unit));
  }
  if (std::all_of(texts.begin(), texts.end(), [&](const std::string& text) { return text == texts.front(); })) {
    return texts.front();
  }
  std::string text = texts.back();
  for (std::size_t s = texts.size() - 1; s-- > 0;) {
    text = fmt::format("{} ? {} : {}", condition_of(population, population.sides[s]), texts[s], text);
  }
  return text;
}

Json parameter_json(const ForeignPopulation& population, const std::string& name) {
  const bool varies = std::any_of(population.sides.begin(), population.sides.end(),
                                  [&](const ForeignSide& side) { return side.parameters.at(name).numbers.size() > 1; });
  if (!varies) {
    return value_text(population, name, 0);
  }
  Json list = Json::array();
  for (std::uint32_t i = 0; i < population.size; ++i) {
    list.push_back(value_text(population, name, i));
  }
  return list;
}

Json receptor_json(const ForeignReceptor& receptor) {
  Json json = Json::object();
  if (receptor.kind != "exponential") {
    json["kind"] = receptor.kind;
  }
  if (receptor.kind == "exponential") {
    json["tau"] = quantity_text(receptor.time_ms, "ms");
  } else if (receptor.kind == "boxcar") {
    json["window"] = quantity_text(receptor.time_ms, "ms");
  }
  return json;
}

void add_population(const ForeignPopulation& population, Json& neurons, Json& populations) {
  Json type = {{"model", population.model}};
  Json made = Json::object();
  const bool is_retina = population.more.contains("input");
  if (!is_retina) {
    made = {{"neuron", population.name}, {"size", population.size}};
  }
  if (!population.axes.empty()) {
    made["axis"] = population.axes.size() == 1 ? Json(population.axes.front()) : Json(population.axes);
  }
  made.update(population.more);
  for (const auto& [name, value] : population.sides.front().parameters) {
    Json json = parameter_json(population, name);
    // What differs between neurons belongs to the population; the type is for what they share.
    const bool is_shared = !json.is_array() && json.get_ref<const std::string&>().find('?') == std::string::npos;
    (is_shared && !is_retina ? type : made)[name] = std::move(json);
  }
  for (const ForeignReceptor& receptor : population.receptors) {
    type["receptors"][receptor.name] = receptor_json(receptor);
  }
  if (population.model == "spike_list") {
    type["times"] = Json::array();
    for (const double time_ms : population.spike_times_ms) {
      type["times"].push_back(quantity_text(time_ms, "ms"));
    }
  }
  if (!is_retina) {
    neurons[population.name] = std::move(type);
  }
  populations[population.name] = std::move(made);
}

bool is_constant(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [&](double value) { return value == values.front(); });
}

/// Constant weights and delays are said in the circuit, the others in columns.
std::string write_edge_list(const ForeignProjection& projection, const std::string& path) {
  const bool has_weights = !is_constant(projection.weight);
  const bool has_delays = !is_constant(projection.delay_ms);
  TextFile file(path);
  file.write("pre,post{}{}\n", has_weights ? ",weight" : "", has_delays ? ",delay_ms" : "");
  for (std::size_t s = 0; s < projection.pre.size(); ++s) {
    file.write("{},{}", projection.pre[s], projection.post[s]);
    if (has_weights) {
      file.write(",{}", projection.weight[s]);
    }
    if (has_delays) {
      file.write(",{}", projection.delay_ms[s]);
    }
    file.write("\n");
  }
  return file.close();
}

Json projection_json(const ForeignProjection& projection, const std::string& file) {
  Json columns = Json::object();
  Json made = {{"from", projection.from}, {"to", projection.to}};
  const bool has_weights = !is_constant(projection.weight);
  const bool has_delays = !is_constant(projection.delay_ms);
  made["rule"] = {{"kind", "edges"}, {"file", file}};
  if (has_weights) {
    columns["weight"] = "weight";
  }
  if (has_delays) {
    columns["delay"] = "delay_ms";
  }
  if (!columns.empty()) {
    made["rule"]["columns"] = std::move(columns);
  }
  if (!projection.receptor.empty()) {
    made["receptor"] = projection.receptor;
  }
  if (projection.is_inhibitory) {
    made["sign"] = "inhibitory";
  }
  const std::string after_one = unit_text(projection.weight_unit);
  const std::string unit = after_one.empty() ? "" : " * (1" + after_one + ")";
  made["weight"] =
      has_weights ? "edge.weight" + unit : quantity_text(projection.weight.front(), projection.weight_unit);
  made["delay"] = has_delays ? "edge.delay * 1 ms" : quantity_text(projection.delay_ms.front(), "ms");
  return made;
}

}  // namespace

std::string circuit_name_of(const std::string& text) {
  std::string name;
  for (const char c : text) {
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  const bool begins_well = !name.empty() && std::isdigit(static_cast<unsigned char>(name.front())) == 0;
  return begins_well ? name : "_" + name;
}

std::string write_foreign_circuit(const ForeignCircuit& circuit, const std::string& path,
                                  const ExchangeProgress& progress) {
  const std::filesystem::path file(path);
  const std::string folder = file.stem().string() + "_wiring";
  Json json = {{"tectum", 1}, {"name", circuit.name}};
  if (!circuit.about.empty()) {
    json["about"] = circuit.about;
  }
  json["tick"] = quantity_text(circuit.tick_ms, "ms");
  for (const auto& [key, value] : circuit.rest.items()) {
    json[key] = value;
  }
  Json& neurons = json["neurons"] = Json::object();
  Json& populations = json["populations"] = Json::object();
  for (const ForeignPopulation& population : circuit.populations) {
    add_population(population, neurons, populations);
  }
  Json projections = Json::object();
  for (std::size_t p = 0; p < circuit.projections.size(); ++p) {
    const ForeignProjection& projection = circuit.projections[p];
    const std::string list = folder + "/" + projection.name + ".csv";
    projections[projection.name] = projection_json(projection, list);
    const std::string problem = write_edge_list(projection, (file.parent_path() / list).string());
    if (!problem.empty()) {
      return problem;
    }
    progress(static_cast<double>(p + 1) / static_cast<double>(circuit.projections.size()));
  }
  json["projections"] = std::move(projections);
  if (!circuit.silenced.empty()) {
    json["lesions"]["silenced"] = {{"remove", circuit.silenced}};
  }
  const FormattedCircuit formatted = format_circuit(json.dump());
  TextFile text(path);
  text.write("{}", formatted.text.value_or(json.dump(2) + "\n"));
  return text.close();
}

}  // namespace tectum
