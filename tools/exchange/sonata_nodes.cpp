#include "tools/exchange/sonata_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>

#include "runtime/image/models.h"
#include "tools/exchange/format_limits.h"
#include "tools/exchange/hdf5_file.h"
#include "tools/exchange/nest_model.h"
#include "tools/exchange/sonata_types.h"

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

/// A node type in Tectum's words.
struct NodeType {
  std::string model;
  std::vector<ForeignReceptor> receptors;
  std::map<std::string, ForeignValue> parameters;
  std::map<std::string, std::string> nest_name;  // of parameters that single nodes may override
  double weight_scale = 1;
};

/// "30 ms" -> 30 and "ms".
std::optional<ForeignValue> quantity_of(const std::string& text) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{}) {
    return std::nullopt;
  }
  std::string unit(end, text.data() + text.size());
  unit.erase(0, unit.find_first_not_of(' '));
  return ForeignValue{{value}, unit};
}

/// "ex:exponential:2,in:instantaneous"; nothing when it says anything else.
std::optional<std::vector<ForeignReceptor>> receptors_of(const std::string& text, double tick_ms) {
  std::vector<ForeignReceptor> receptors;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string one = text.substr(at, end - at);
    at = end + 1;
    const std::size_t first = one.find(':');
    if (first == std::string::npos) {
      return std::nullopt;
    }
    const std::size_t second = std::min(one.find(':', first + 1), one.size());
    ForeignReceptor receptor{one.substr(0, first), one.substr(first + 1, second - first - 1), 0};
    if (second < one.size()) {
      const auto time = quantity_of(one.substr(second + 1));
      if (!time) {
        return std::nullopt;
      }
      receptor.time_ms = receptor.kind == "boxcar" ? time->numbers.front() * tick_ms : time->numbers.front();
    }
    receptors.push_back(std::move(receptor));
  }
  return receptors;
}

/// What NEST's units rounded comes back from its own column, unless somebody has changed the value since.
void take_kept(const SonataTable& table, std::size_t row, std::map<std::string, ForeignValue>& parameters) {
  constexpr double kRounding = 1e-12;
  for (const char* name : kKeptParameters) {
    const auto kept = table.number(row, std::string("tectum_") + name);
    const auto found = parameters.find(name);
    if (kept && found != parameters.end()) {
      double& value = found->second.numbers.front();
      value = std::abs(value - *kept) <= kRounding * std::abs(*kept) ? *kept : value;
    }
  }
}

class NodeReader {
 public:
  NodeReader(const SonataConfig& config, double tick_ms, std::string& error)
      : config_(config), tick_ms_(tick_ms), error_(error) {}

  std::optional<SonataNodes> run() {
    for (const SonataFile& file : config_.nodes) {
      if (!read_file(file)) {
        return std::nullopt;
      }
    }
    if (!undriven_.empty()) {
      nodes_.warnings.push_back("the spike trains of " + list_names(undriven_) +
                                " differ from node to node and are left out: the cells are there and silent");
    }
    return std::move(nodes_);
  }

 private:
  bool fail(const std::string& message) {
    error_ = message;
    return false;
  }

  bool read_file(const SonataFile& file) {
    if (file.types.empty()) {
      return fail(fmt::format("{}: has no table of node types beside it; name the configuration that says where it is",
                              file.data));
    }
    auto table = read_sonata_table(file.types, error_);
    const auto data = Hdf5Reader::open(file.data, error_);
    if (!table || !data) {
      return false;
    }
    if (!data->has("/nodes")) {
      return fail(file.data + ": has no /nodes");
    }
    for (const Hdf5Entry& entry : data->list("/nodes")) {
      if (entry.is_group && !read_population(file, *table, *data, entry.name)) {
        return false;
      }
    }
    return true;
  }

  bool read_population(const SonataFile& file, const SonataTable& table, Hdf5Reader& data, const std::string& name) {
    const std::string group = "/nodes/" + name;
    const auto type_ids = data.integers(group + "/node_type_id");
    if (!type_ids) {
      return fail(fmt::format("{}: `{}` has no node_type_id", file.data, name));
    }
    if (nodes_.places.count(name) != 0) {
      return fail(fmt::format("{}: the population `{}` is there twice", file.data, name));
    }
    // Rows of the table, by type id.
    std::map<std::int64_t, std::size_t> row_of;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const auto id = table.number(row, "node_type_id");
      const auto population = table.field(row, "population");
      if (id && (!population || *population == name)) {
        row_of.emplace(static_cast<std::int64_t>(*id), row);
      }
    }
    std::map<std::int64_t, NodeType> types;
    for (const std::int64_t id : *type_ids) {
      if (types.count(id) == 0) {
        const auto row = row_of.find(id);
        if (row == row_of.end()) {
          return fail(
              fmt::format("{}: `{}` has nodes of type {}, which {} does not list", file.data, name, id, file.types));
        }
        auto type = read_type(table, row->second, name, file.types);
        if (!type) {
          return false;
        }
        types.emplace(id, std::move(*type));
      }
    }
    const bool is_own = std::find(table.columns.begin(), table.columns.end(), "tectum_model") != table.columns.end();
    if (!make_cells(table, row_of, types, *type_ids, name, is_own)) {
      return false;
    }
    take_ids(data, group, name);
    return take_single_values(data, file, group, name, types, *type_ids);
  }

  std::optional<NodeType> read_type(const SonataTable& table, std::size_t row, const std::string& population,
                                    const std::string& path) {
    const std::string model_type = table.field(row, "model_type").value_or("");
    const std::string model_template = table.field(row, "model_template").value_or("");
    const std::string what = fmt::format("{}: node type {} of `{}`", path, table.rows[row].front(), population);
    Json dynamics = Json::object();
    if (const auto file = table.field(row, "dynamics_params")) {
      auto read = read_json((std::filesystem::path(config_.point_neuron_models_dir) / *file).string(), error_);
      if (!read) {
        return std::nullopt;
      }
      dynamics = std::move(*read);
    }
    NodeType type;
    const auto own_model = table.field(row, "tectum_model");
    if (model_type == "virtual" || model_template.rfind("tectum:", 0) == 0) {
      type.model = own_model.value_or("spike_list");
      native_values(dynamics, type);
    } else if (model_type != "point_neuron" && model_type != "point_process") {
      fail(fmt::format("{} is `{}`: Tectum has point neurons only", what, model_type));
      return std::nullopt;
    } else if (!nest_values(model_template, dynamics, what, type)) {
      return std::nullopt;
    }
    take_kept(table, row, type.parameters);
    if (own_model) {
      const auto receptors = receptors_of(table.field(row, "tectum_receptors").value_or(""), tick_ms_);
      if (!receptors) {
        fail(what + " has receptors that cannot be read");
        return std::nullopt;
      }
      take_times(*receptors, type);
    }
    return type;
  }

  static void native_values(const Json& dynamics, NodeType& type) {
    for (const auto& [name, value] : dynamics.items()) {
      if (value.is_string()) {
        if (auto quantity = quantity_of(value.get<std::string>())) {
          type.parameters[name] = std::move(*quantity);
        }
      } else if (value.is_number()) {
        type.parameters[name] = {{value.get<double>()}, ""};
      }
    }
  }

  bool nest_values(const std::string& model_template, const Json& dynamics, const std::string& what, NodeType& type) {
    if (model_template.rfind("nest:", 0) != 0) {
      return fail(fmt::format("{} is `{}`: Tectum reads models of NEST (`nest:...`)", what, model_template));
    }
    std::map<std::string, double> numbers;
    std::map<std::string, std::vector<double>> lists;
    for (const auto& [name, value] : dynamics.items()) {
      if (value.is_number()) {
        numbers[name] = value.get<double>();
      } else if (value.is_boolean()) {
        numbers[name] = value.get<bool>() ? 1 : 0;
      } else if (value.is_array()) {
        for (const Json& item : value) {
          lists[name].push_back(item.is_number() ? item.get<double>() : 0);
        }
      }
    }
    std::string why;
    const auto native = native_model(model_template.substr(5), numbers, lists, tick_ms_, why);
    if (!native) {
      return fail(fmt::format("{}: {}", what, why));
    }
    type.model = native->model;
    type.weight_scale = native->weight_scale;
    const ModelInfo* info = find_model(native->model);
    for (const auto& [name, value] : native->parameters) {
      type.parameters[name] = {{value}, built_in_parameter_unit(info->kind, name)};
    }
    for (const auto& [name, tau_ms] : native->tau_syn_ms) {
      type.receptors.push_back({name, "exponential", tau_ms});
    }
    if (native->is_delta) {
      type.receptors = {{"ex", "instantaneous", 0}, {"in", "instantaneous", 0}};
    }
    return true;
  }

  /// Names and kinds of receptors are Tectum's own; times that NEST knows are NEST's.
  static void take_times(const std::vector<ForeignReceptor>& own, NodeType& type) {
    std::vector<ForeignReceptor> receptors = own;
    for (std::size_t r = 0; r < receptors.size(); ++r) {
      for (const ForeignReceptor& nest : type.receptors) {
        const bool is_same = nest.name == receptors[r].name || nest.name == fmt::format("port_{}", r + 1);
        if (is_same && receptors[r].kind == "exponential" && nest.kind == "exponential") {
          receptors[r].time_ms = nest.time_ms;
        }
      }
    }
    type.receptors = std::move(receptors);
  }

  /// Types of one population become one, side by side, when the export took them apart; else one population each.
  bool make_cells(const SonataTable& table, const std::map<std::int64_t, std::size_t>& row_of,
                  const std::map<std::int64_t, NodeType>& types, const std::vector<std::int64_t>& type_ids,
                  const std::string& name, bool is_own) {
    std::map<std::int64_t, std::uint32_t> cells_of;
    for (const auto& [id, type] : types) {
      if (is_own && !cells_of.empty()) {
        const SonataCells& before = nodes_.cells[cells_of.begin()->second];
        if (before.model != type.model) {
          return fail(
              fmt::format("the node types of `{}` have different models, {} and {}", name, before.model, type.model));
        }
        cells_of[id] = cells_of.begin()->second;
        continue;
      }
      cells_of[id] = static_cast<std::uint32_t>(nodes_.cells.size());
      SonataCells cells;
      cells.node_population = name;
      cells.is_own = is_own;
      cells.name = name;
      if (!is_own) {
        const std::size_t row = row_of.at(id);
        const std::string label = table.field(row, "pop_name").value_or(fmt::format("{}", id));
        cells.name = types.size() == 1 ? circuit_name_of(name) : circuit_name_of(name + "_" + label);
        while (used_.count(cells.name) != 0) {
          cells.name += fmt::format("_{}", id);
        }
      }
      used_.insert(cells.name);
      cells.model = type.model;
      cells.receptors = type.receptors;
      cells.weight_scale = type.weight_scale;
      nodes_.cells.push_back(std::move(cells));
    }
    std::vector<SonataPlace>& places = nodes_.places[name];
    for (const std::int64_t id : type_ids) {
      SonataCells& cells = nodes_.cells[cells_of.at(id)];
      places.push_back({cells_of.at(id), cells.size++});
      for (const auto& [parameter, value] : types.at(id).parameters) {
        ForeignValue& all = cells.parameters[parameter];
        all.unit = value.unit;
        all.numbers.push_back(value.numbers.front());
      }
    }
    for (const auto& [id, index] : cells_of) {
      finish(nodes_.cells[index]);
    }
    return true;
  }

  void finish(SonataCells& cells) {
    for (auto& [name, value] : cells.parameters) {
      const double first = value.numbers.front();
      if (std::all_of(value.numbers.begin(), value.numbers.end(), [&](double x) { return x == first; })) {
        value.numbers.resize(1);
      }
    }
    if (cells.model == "spike_list") {
      take_spikes(cells);
    }
  }

  /// A spike_list's neurons fire together.
  void take_spikes(SonataCells& cells) {
    const auto path = config_.spike_files.find(cells.node_population);
    std::string why;
    const auto file = path == config_.spike_files.end() ? nullptr : Hdf5Reader::open(path->second, why);
    if (!file) {
      return;
    }
    std::string group = "/spikes/" + cells.node_population;
    group = file->has(group) ? group : "/spikes";
    const auto times = file->numbers(group + "/timestamps");
    const auto ids =
        file->has(group + "/node_ids") ? file->integers(group + "/node_ids") : file->integers(group + "/gids");
    if (!times || !ids || times->size() != ids->size()) {
      return;
    }
    std::map<double, std::uint32_t> count;
    for (const double time : *times) {
      ++count[time];
    }
    if (std::any_of(count.begin(), count.end(), [&](const auto& entry) { return entry.second != cells.size; })) {
      undriven_.push_back(cells.node_population);
      return;
    }
    for (const auto& [time, fired] : count) {
      cells.spike_times_ms.push_back(time);
    }
  }

  void take_ids(Hdf5Reader& data, const std::string& group, const std::string& name) {
    const auto ids = data.has(group + "/node_id") ? data.integers(group + "/node_id") : std::nullopt;
    if (!ids) {
      return;
    }
    std::map<std::int64_t, std::uint32_t> row_of;
    bool is_plain = true;
    for (std::size_t row = 0; row < ids->size(); ++row) {
      row_of.emplace((*ids)[row], static_cast<std::uint32_t>(row));
      is_plain = is_plain && (*ids)[row] == static_cast<std::int64_t>(row);
    }
    if (!is_plain) {
      nodes_.row_of_id[name] = std::move(row_of);
    }
  }

  /// Parameters that nodes have for themselves: dynamics_params of their group, and Tectum's own beside them.
  bool take_single_values(Hdf5Reader& data, const SonataFile& file, const std::string& group, const std::string& name,
                          const std::map<std::int64_t, NodeType>& types, const std::vector<std::int64_t>& type_ids) {
    const std::vector<SonataPlace>& places = nodes_.places[name];
    const auto values_of = [&](const std::string& path) { return data.numbers(path); };
    for (const Hdf5Entry& entry : data.list(group + "/0/dynamics_params")) {
      const auto values = values_of(group + "/0/dynamics_params/" + entry.name);
      if (!values || values->size() != places.size()) {
        return fail(fmt::format("{}: `{}` of `{}` has not one value a node", file.data, entry.name, name));
      }
      for (std::size_t i = 0; i < places.size(); ++i) {
        SonataCells& cells = nodes_.cells[places[i].cells];
        const auto native = single_value(entry.name, (*values)[i], cells.model, types.at(type_ids[i]));
        if (!native) {
          return fail(fmt::format("{}: Tectum has no counterpart of `{}`, which the nodes of `{}` have for themselves",
                                  file.data, entry.name, name));
        }
        ForeignValue& all = cells.parameters[native->first];
        all.numbers.resize(cells.size, all.numbers.empty() ? 0 : all.numbers.front());
        all.numbers[places[i].index] = native->second;
      }
    }
    for (const char* kept : kKeptParameters) {
      const std::string path = fmt::format("{}/0/tectum_{}", group, kept);
      const auto values = data.has(path) ? values_of(path) : std::nullopt;
      for (std::size_t i = 0; values && i < places.size() && i < values->size(); ++i) {
        ForeignValue& all = nodes_.cells[places[i].cells].parameters[kept];
        double& value = all.numbers[all.numbers.size() == 1 ? 0 : places[i].index];
        constexpr double kRounding = 1e-12;
        value = std::abs(value - (*values)[i]) <= kRounding * std::abs((*values)[i]) ? (*values)[i] : value;
      }
    }
    return true;
  }

  /// A value of NEST as name and value in Tectum.
  static std::optional<std::pair<std::string, double>> single_value(const std::string& nest_name, double value,
                                                                    const std::string& model, const NodeType& type) {
    if (type.weight_scale == 1 && type.parameters.count(nest_name) != 0) {
      return std::pair{nest_name, value};
    }
    const bool is_membrane = model == "lif_exp" || model == "lif_delta" || model == "alif";
    for (const char* same : {"E_L", "V_th", "V_reset", "a", "b", "c", "d", "rate"}) {
      if (nest_name == same && type.parameters.count(same) != 0) {
        return std::pair{nest_name, value};
      }
    }
    if (nest_name == "V_m") {
      return std::pair{std::string("V_init"), value};
    }
    if (nest_name == "I_e") {
      return std::pair{std::string("I_bias"), is_membrane ? value / 1000 : value};
    }
    return std::nullopt;
  }

  const SonataConfig& config_;
  double tick_ms_;
  std::string& error_;
  SonataNodes nodes_;
  std::set<std::string> used_;
  std::vector<std::string> undriven_;
};

}  // namespace

std::optional<SonataNodes> read_sonata_nodes(const SonataConfig& config, double tick_ms, std::string& error) {
  return NodeReader(config, tick_ms, error).run();
}

}  // namespace tectum
