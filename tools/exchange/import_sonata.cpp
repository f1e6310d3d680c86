#include "tools/exchange/import_sonata.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <tuple>

#include "compiler/validate/scope.h"
#include "runtime/image/models.h"
#include "tools/exchange/format_limits.h"
#include "tools/exchange/hdf5_file.h"
#include "tools/exchange/sonata_nodes.h"

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDefaultTickMs = 0.1;

/// One edge type in Tectum's words.
struct EdgeType {
  std::string projection;  // empty: to be named after its ends
  std::string receptor;    // empty: by sign
  std::uint32_t port = 0;  // of NEST, from 1
  std::optional<double> weight;
  std::optional<double> delay_ms;
};

class SonataImport {
 public:
  SonataImport(const SonataConfig& config, const SonataImportOptions& options, std::string& error,
               const ExchangeProgress& progress)
      : config_(config), error_(error), progress_(progress) {
    made_.tick_ms = options.tick_ms.value_or(config.dt_ms.value_or(kDefaultTickMs));
    has_own_tick_ = options.tick_ms.has_value();
  }

  std::optional<ForeignCircuit> run() {
    auto nodes = read_sonata_nodes(config_, made_.tick_ms, error_);
    if (!nodes) {
      return std::nullopt;
    }
    nodes_ = std::move(*nodes);
    made_.warnings = nodes_.warnings;
    take_rest();
    if (!make_populations()) {
      return std::nullopt;
    }
    for (const SonataFile& file : config_.edges) {
      if (!read_edges(file)) {
        return std::nullopt;
      }
    }
    name_projections();
    return std::move(made_);
  }

 private:
  bool fail(const std::string& message) {
    error_ = message;
    return false;
  }

  void take_rest() {
    made_.name.clear();
    for (const auto& [key, value] : config_.rest.items()) {
      if (key == "name" && value.is_string()) {
        made_.name = value.get<std::string>();
      } else if (key == "silenced" && value.is_array()) {
        for (const Json& name : value) {
          made_.silenced.push_back(renamed(name.is_string() ? name.get<std::string>() : ""));
        }
      } else if (key != "tectum" && key != "populations" && !(key == "tick" && has_own_tick_)) {
        made_.rest[key] = value;
      }
    }
    if (made_.rest.contains("outputs") && made_.rest["outputs"].is_object()) {
      for (auto& [name, output] : made_.rest["outputs"].items()) {
        rename_terms(output);
      }
    }
  }

  /// Outputs speak of populations by name.
  void rename_terms(Json& output) {
    if (output.contains("rate_difference") && output["rate_difference"].is_array()) {
      for (Json& name : output["rate_difference"]) {
        name = name.is_string() ? Json(renamed(name.get<std::string>())) : name;
      }
    }
    if (output.contains("terms") && output["terms"].is_array()) {
      for (Json& term : output["terms"]) {
        if (term.contains("population") && term["population"].is_string()) {
          term["population"] = renamed(term["population"].get<std::string>());
        }
      }
    }
  }

  /// Parts of a module's instance, "gaze.EBN", become populations of their own, "gaze_EBN"; sides keep their point.
  std::string renamed(const std::string& name) const {
    if (config_.rest.contains("populations")) {
      for (const auto& [base, said] : config_.rest["populations"].items()) {
        const bool is_it = name.rfind(base, 0) == 0 && (name.size() == base.size() || name[base.size()] == '.');
        if (is_it && base.find('.') != std::string::npos) {
          std::string plain = base;
          std::replace(plain.begin(), plain.end(), '.', '_');
          return plain + name.substr(base.size());
        }
      }
    }
    return name;
  }

  /// Every combination of sides of these axes, the first axis slowest.
  std::vector<std::vector<std::string>> side_combinations(const Json& axes) const {
    std::vector<std::vector<std::string>> combinations = {{}};
    for (const Json& axis : axes) {
      std::vector<std::vector<std::string>> longer;
      for (const std::vector<std::string>& sides : combinations) {
        for (const Json& side : config_.rest["axes"][axis.get<std::string>()]) {
          longer.push_back(sides);
          longer.back().push_back(side.get<std::string>());
        }
      }
      combinations = std::move(longer);
    }
    return combinations;
  }

  bool make_populations() {
    std::set<std::uint32_t> taken;
    if (config_.rest.contains("populations")) {
      for (const auto& [base, said] : config_.rest["populations"].items()) {
        if (!make_own_population(base, said, taken)) {
          return false;
        }
      }
    }
    for (std::uint32_t c = 0; c < nodes_.cells.size(); ++c) {
      if (taken.count(c) == 0) {
        ForeignPopulation population = population_of(nodes_.cells[c]);
        population.name = circuit_name_of(population.name);
        nodes_.cells[c].name = population.name;
        population.sides.push_back({{}, nodes_.cells[c].parameters});
        made_.populations.push_back(std::move(population));
      }
    }
    return true;
  }

  ForeignPopulation population_of(const SonataCells& cells) {
    ForeignPopulation population;
    population.name = cells.name;
    population.model = cells.model;
    population.receptors = cells.receptors;
    population.size = cells.size;
    population.spike_times_ms = cells.spike_times_ms;
    return population;
  }

  /// A population that Tectum wrote: its sides are node populations.
  bool make_own_population(const std::string& base, const Json& said, std::set<std::uint32_t>& taken) {
    const Json axes = said.contains("axis") ? said["axis"] : Json::array();
    const bool knows_axes = axes.is_array() && std::all_of(axes.begin(), axes.end(), [&](const Json& axis) {
                              return axis.is_string() && config_.rest.contains("axes") &&
                                     config_.rest["axes"].contains(axis.get<std::string>());
                            });
    if (!knows_axes) {
      return fail(fmt::format("tectum.json: `{}` lies on an axis that is not declared there", base));
    }
    std::optional<ForeignPopulation> made;
    for (const std::vector<std::string>& sides : side_combinations(axes)) {
      const std::string name = sides.empty() ? base : fmt::format("{}.{}", base, fmt::join(sides, "."));
      const auto found = std::find_if(nodes_.cells.begin(), nodes_.cells.end(),
                                      [&](const SonataCells& cells) { return cells.name == name; });
      if (found == nodes_.cells.end()) {
        return fail(fmt::format("tectum.json names `{}`, and no nodes file has it", name));
      }
      if (made && (made->model != found->model || made->size != found->size)) {
        return fail(fmt::format("the sides of `{}` differ in model or size, so they are no mirror images", base));
      }
      taken.insert(static_cast<std::uint32_t>(found - nodes_.cells.begin()));
      if (!made) {
        made = population_of(*found);
        made->name = renamed(base);
      }
      made->sides.push_back({sides, found->parameters});
      found->name = renamed(name);
    }
    for (const Json& axis : axes) {
      made->axes.push_back(axis.get<std::string>());
    }
    for (const auto& [key, value] : said.items()) {
      if (key != "axis") {
        made->more[key] = value;
      }
    }
    if (made->name != base && made->model == "poisson") {
      made_.warnings.push_back(
          fmt::format("`{}` of a module is now `{}`: Poisson spikes are keyed by the name, so its spikes are others",
                      base, made->name));
    }
    made_.populations.push_back(std::move(*made));
    return true;
  }

  bool read_edges(const SonataFile& file) {
    std::map<std::int64_t, EdgeType> types;
    if (!file.types.empty() && !read_edge_types(file.types, types)) {
      return false;
    }
    const auto data = Hdf5Reader::open(file.data, error_);
    if (!data) {
      return false;
    }
    if (!data->has("/edges")) {
      return fail(file.data + ": has no /edges");
    }
    const std::vector<Hdf5Entry> populations = data->list("/edges");
    for (std::size_t p = 0; p < populations.size(); ++p) {
      if (populations[p].is_group && !read_edge_population(file, *data, populations[p].name, types)) {
        return false;
      }
      progress_(static_cast<double>(p + 1) / static_cast<double>(populations.size()));
    }
    return true;
  }

  bool read_edge_types(const std::string& path, std::map<std::int64_t, EdgeType>& types) {
    const auto table = read_sonata_table(path, error_);
    if (!table) {
      return false;
    }
    for (std::size_t row = 0; row < table->rows.size(); ++row) {
      const auto id = table->number(row, "edge_type_id");
      if (!id) {
        return fail(path + ": has no edge_type_id");
      }
      EdgeType type;
      type.projection = table->field(row, "tectum_projection").value_or("");
      type.receptor = table->field(row, "tectum_receptor").value_or("");
      type.weight = table->number(row, "syn_weight");
      type.delay_ms = table->number(row, "delay");
      const std::string synapse = table->field(row, "model_template").value_or("static_synapse");
      if (synapse != "static_synapse" && synapse != "nest:static_synapse") {
        return fail(fmt::format("{}: edge type {} is `{}`: Tectum has static synapses here", path, *id, synapse));
      }
      if (const auto file = table->field(row, "dynamics_params")) {
        const auto dynamics = read_json((std::filesystem::path(config_.synaptic_models_dir) / *file).string(), error_);
        if (!dynamics) {
          return false;
        }
        if (dynamics->is_object() && dynamics->contains("receptor_type") &&
            (*dynamics)["receptor_type"].is_number_unsigned()) {
          type.port = (*dynamics)["receptor_type"].get<std::uint32_t>();
        }
      }
      types[static_cast<std::int64_t>(*id)] = std::move(type);
    }
    return true;
  }

  /// The edges of one population, as columns.
  struct Edges {
    std::string name, from, to;
    std::vector<std::int64_t> source, target, type;
    std::vector<double> weight, native, count, delay_ms;  // empty where the file has none
  };

  std::optional<Edges> read_columns(const SonataFile& file, Hdf5Reader& data, const std::string& name) {
    const std::string group = "/edges/" + name;
    Edges edges;
    edges.name = name;
    auto source = data.integers(group + "/source_node_id");
    auto target = data.integers(group + "/target_node_id");
    auto type = data.integers(group + "/edge_type_id");
    const auto from = data.text_attribute(group + "/source_node_id", "node_population");
    const auto to = data.text_attribute(group + "/target_node_id", "node_population");
    if (!source || !target || !type || !from || !to || source->size() != target->size() ||
        type->size() != source->size()) {
      fail(
          fmt::format("{}: `{}` lacks source_node_id, target_node_id (with their node_population) or edge_type_id, or "
                      "they differ in length",
                      file.data, name));
      return std::nullopt;
    }
    edges.from = *from;
    edges.to = *to;
    for (const std::string& end : {edges.from, edges.to}) {
      if (nodes_.places.count(end) == 0) {
        fail(fmt::format("{}: `{}` speaks of nodes of `{}`, which no nodes file has", file.data, name, end));
        return std::nullopt;
      }
    }
    edges.source = std::move(*source);
    edges.target = std::move(*target);
    edges.type = std::move(*type);
    const std::pair<const char*, std::vector<double>*> columns[] = {{"syn_weight", &edges.weight},
                                                                    {"tectum_weight", &edges.native},
                                                                    {"nsyns", &edges.count},
                                                                    {"delay", &edges.delay_ms}};
    for (const auto& [column, values] : columns) {
      if (!read_column(data, group, column, edges.source.size(), *values)) {
        fail(fmt::format("{}: `{}` of `{}` has not one value an edge", file.data, column, name));
        return std::nullopt;
      }
    }
    return edges;
  }

  /// A column is spread over the edge groups; edges say which group and row is theirs.
  static bool read_column(Hdf5Reader& data, const std::string& group, const std::string& column, std::size_t count,
                          std::vector<double>& values) {
    const auto group_of = data.has(group + "/edge_group_id") ? data.integers(group + "/edge_group_id") : std::nullopt;
    const auto row_of =
        data.has(group + "/edge_group_index") ? data.integers(group + "/edge_group_index") : std::nullopt;
    std::map<std::int64_t, std::vector<double>> parts;
    for (const Hdf5Entry& entry : data.list(group)) {
      const std::string path = group + "/" + entry.name + "/" + column;
      const bool is_number =
          std::all_of(entry.name.begin(), entry.name.end(), [](char c) { return c >= '0' && c <= '9'; });
      if (entry.is_group && is_number && data.has(path)) {
        auto part = data.numbers(path);
        if (!part) {
          return false;
        }
        parts[std::stoll(entry.name)] = std::move(*part);
      }
    }
    if (parts.empty()) {
      return true;
    }
    if (!group_of || !row_of) {
      values = std::move(parts.begin()->second);
      return values.size() == count;
    }
    values.assign(count, std::nan(""));
    for (std::size_t e = 0; e < count && e < group_of->size() && e < row_of->size(); ++e) {
      const auto part = parts.find((*group_of)[e]);
      const auto row = static_cast<std::uint64_t>((*row_of)[e]);
      if (part != parts.end()) {
        if (row >= part->second.size()) {
          return false;
        }
        values[e] = part->second[row];
      }
    }
    return true;
  }

  [[nodiscard]] std::optional<SonataPlace> place_of(const std::string& population, std::int64_t id) const {
    const std::vector<SonataPlace>& places = nodes_.places.at(population);
    const auto ids = nodes_.row_of_id.find(population);
    if (ids != nodes_.row_of_id.end()) {
      const auto row = ids->second.find(id);
      return row == ids->second.end() ? std::nullopt : std::optional(places[row->second]);
    }
    const auto row = static_cast<std::uint64_t>(id);
    return row < places.size() ? std::optional(places[row]) : std::nullopt;
  }

  bool read_edge_population(const SonataFile& file, Hdf5Reader& data, const std::string& name,
                            const std::map<std::int64_t, EdgeType>& types) {
    const auto edges = read_columns(file, data, name);
    if (!edges) {
      return false;
    }
    const EdgeType plain;
    for (std::size_t e = 0; e < edges->source.size(); ++e) {
      const auto type = types.find(edges->type[e]);
      if (type == types.end() && !types.empty()) {
        return fail(fmt::format("{}: edge {} of `{}` is of type {}, which {} does not list", file.data, e, name,
                                edges->type[e], file.types));
      }
      const auto pre = place_of(edges->from, edges->source[e]);
      const auto post = place_of(edges->to, edges->target[e]);
      if (!pre || !post) {
        return fail(fmt::format("{}: edge {} of `{}` leads {} node {}, which `{}` does not have", file.data, e, name,
                                pre ? "to" : "from", pre ? edges->target[e] : edges->source[e],
                                pre ? edges->to : edges->from));
      }
      if (!add_edge(file, *edges, e, type == types.end() ? plain : type->second, *pre, *post)) {
        return false;
      }
    }
    return true;
  }

  bool add_edge(const SonataFile& file, const Edges& edges, std::size_t e, const EdgeType& type, SonataPlace pre,
                SonataPlace post) {
    const SonataCells& target = nodes_.cells[post.cells];
    const double nan = std::nan("");
    double weight = edges.weight.empty() ? type.weight.value_or(nan) : edges.weight[e];
    weight = std::isnan(weight) ? type.weight.value_or(nan) : weight;
    double delay_ms = edges.delay_ms.empty() ? nan : edges.delay_ms[e];
    delay_ms = std::isnan(delay_ms) ? type.delay_ms.value_or(nan) : delay_ms;
    if (std::isnan(weight) || std::isnan(delay_ms)) {
      return fail(fmt::format("{}: edge {} of `{}` has no {}, and neither has its type", file.data, e, edges.name,
                              std::isnan(weight) ? "syn_weight" : "delay"));
    }
    if (!edges.count.empty() && !std::isnan(edges.count[e])) {
      weight *= edges.count[e];
    }
    double native = weight / target.weight_scale;
    constexpr double kRounding = 1e-12;
    if (!edges.native.empty() && std::abs(native - edges.native[e]) <= kRounding * std::abs(native)) {
      native = edges.native[e];
    }
    const auto tick_ns = static_cast<std::uint64_t>(std::llround(made_.tick_ms * 1e6));
    if (!whole_ticks(delay_ms, tick_ns)) {
      return fail(
          fmt::format("{}: edge {} of `{}` has a delay of {} ms, which is no whole number of ticks of {} ms; "
                      "--tick sets another",
                      file.data, e, edges.name, delay_ms, made_.tick_ms));
    }
    if (target.receptors.empty()) {
      return fail(fmt::format("{}: `{}` leads to `{}`, which takes no synapses", file.data, edges.name, target.name));
    }
    ForeignProjection* projection = projection_for(edges, type, pre.cells, post.cells, native < 0);
    if (projection == nullptr) {
      return fail(fmt::format("{}: edge {} of `{}` goes to a receptor that `{}` does not have", file.data, e,
                              edges.name, target.name));
    }
    projection->pre.push_back(pre.index);
    projection->post.push_back(post.index);
    projection->weight.push_back(std::abs(native));
    projection->delay_ms.push_back(delay_ms);
    return true;
  }

  using Key = std::tuple<std::string, std::uint32_t, std::uint32_t, std::string, bool>;

  /// Null when the target has no such receptor.
  ForeignProjection* projection_for(const Edges& edges, const EdgeType& type, std::uint32_t pre, std::uint32_t post,
                                    bool is_inhibitory) {
    const SonataCells& target = nodes_.cells[post];
    std::string receptor = type.receptor;
    if (receptor.empty()) {
      receptor = type.port > 0 ? fmt::format("port_{}", type.port) : is_inhibitory ? "in" : "ex";
    }
    const Key key(type.projection.empty() ? edges.name : type.projection, pre, post, receptor, is_inhibitory);
    const auto found = number_of_.find(key);
    if (found != number_of_.end()) {
      return &made_.projections[found->second];
    }
    if (std::none_of(target.receptors.begin(), target.receptors.end(),
                     [&](const ForeignReceptor& r) { return r.name == receptor; })) {
      return nullptr;
    }
    number_of_.emplace(key, made_.projections.size());
    ForeignProjection made;
    made.name = circuit_name_of(std::get<0>(key));
    made.from = nodes_.cells[pre].name;
    made.to = target.name;
    made.receptor = receptor;
    made.is_inhibitory = is_inhibitory;
    made.weight_unit = unit_of(target, receptor);
    made_.projections.push_back(std::move(made));
    return &made_.projections.back();
  }

  std::string unit_of(const SonataCells& target, const std::string& receptor) const {
    if (const ModelInfo* info = find_model(target.model)) {
      return info->weight_unit == "1" ? "" : std::string(info->weight_unit);
    }
    const Json& models = made_.rest.contains("models") ? made_.rest["models"] : Json();
    if (models.contains(target.model) && models[target.model].contains("inputs") &&
        models[target.model]["inputs"].contains(receptor)) {
      const Json& unit = models[target.model]["inputs"][receptor];
      const auto parsed = parse_unit(unit.is_string() ? unit.get<std::string>() : "");
      return parsed ? coherent_unit(parsed->dimension) : "";
    }
    return "";
  }

  /// A projection keeps its name while it is the only one of it; else its ends, and at last its sign, tell it apart.
  void name_projections() {
    std::map<std::string, int> count;
    for (const ForeignProjection& projection : made_.projections) {
      ++count[projection.name];
    }
    std::set<std::string> used;
    for (ForeignProjection& projection : made_.projections) {
      if (count[projection.name] > 1) {
        projection.name = circuit_name_of(fmt::format("{}_{}_{}", projection.name, projection.from, projection.to));
      }
      if (used.count(projection.name) != 0) {
        projection.name += projection.is_inhibitory ? "_inhibitory" : "_" + projection.receptor;
      }
      const std::string name = projection.name;
      for (int n = 2; used.count(projection.name) != 0; ++n) {
        projection.name = fmt::format("{}_{}", name, n);
      }
      used.insert(projection.name);
    }
  }

  const SonataConfig& config_;
  std::string& error_;
  const ExchangeProgress& progress_;
  bool has_own_tick_ = false;
  SonataNodes nodes_;
  std::map<Key, std::size_t> number_of_;
  ForeignCircuit made_;
};

}  // namespace

std::optional<ForeignCircuit> import_sonata(const SonataConfig& config, const SonataImportOptions& options,
                                            std::string& error, const ExchangeProgress& progress) {
  return SonataImport(config, options, error, progress).run();
}

}  // namespace tectum
