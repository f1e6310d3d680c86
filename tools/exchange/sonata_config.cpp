#include "tools/exchange/sonata_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <sstream>

#include "compiler/source/source_file.h"
#include "tools/exchange/hdf5_file.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Replaces $NAME and ${NAME} by the manifest's directories, longest name first, until nothing is left to replace.
class Manifest {
 public:
  Manifest(const Json& config, const fs::path& folder) : folder_(folder) {
    names_.emplace_back("${configdir}", folder.string());
    if (config.contains("manifest") && config["manifest"].is_object()) {
      for (const auto& [name, value] : config["manifest"].items()) {
        if (value.is_string()) {
          names_.emplace_back(name, value.get<std::string>());
        }
      }
    }
    std::stable_sort(names_.begin(), names_.end(),
                     [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
  }

  [[nodiscard]] std::string path(std::string text) const {
    constexpr int kDepth = 8;  // variables may name variables
    for (int depth = 0; depth < kDepth && text.find('$') != std::string::npos; ++depth) {
      for (const auto& [name, value] : names_) {
        for (std::size_t at = text.find(name); at != std::string::npos && !name.empty(); at = text.find(name)) {
          text.replace(at, name.size(), value);
          if (value.find(name) != std::string::npos) {
            break;
          }
        }
      }
    }
    const fs::path found(text);
    return (found.is_absolute() || text.rfind(folder_.string() + "/", 0) == 0 ? found : folder_ / found)
        .lexically_normal()
        .string();
  }

 private:
  fs::path folder_;
  std::vector<std::pair<std::string, std::string>> names_;
};

std::string text_member(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

class ConfigReader {
 public:
  std::optional<SonataConfig> run(const std::string& path, std::string& error) {
    if (!read(path, error)) {
      return std::nullopt;
    }
    if (config_.nodes.empty()) {
      error = path + ": names no nodes: it has no `networks` with `nodes_file`";
      return std::nullopt;
    }
    const fs::path beside = fs::path(circuit_path_).parent_path();
    std::error_code ignored;
    if (fs::exists(beside / "tectum.json", ignored)) {
      auto rest = read_json((beside / "tectum.json").string(), error);
      if (!rest) {
        return std::nullopt;
      }
      config_.rest = std::move(*rest);
    }
    const fs::path simulation = beside / "simulation_config.json";
    if (!config_.dt_ms && fs::exists(simulation, ignored) && !read(simulation.string(), error)) {
      return std::nullopt;
    }
    return std::move(config_);
  }

 private:
  bool read(const std::string& path, std::string& error) {
    const auto json = read_json(path, error);
    if (!json) {
      return false;
    }
    if (!json->is_object()) {
      error = path + ": is no SONATA configuration";
      return false;
    }
    const Manifest manifest(*json, fs::path(path).parent_path());
    networks(*json, manifest, path);
    if (json->contains("components")) {
      const Json& components = (*json)["components"];
      config_.point_neuron_models_dir = manifest.path(text_member(components, "point_neuron_models_dir"));
      config_.synaptic_models_dir = manifest.path(text_member(components, "synaptic_models_dir"));
    }
    if (json->contains("run") && (*json)["run"].is_object() && (*json)["run"].contains("dt") &&
        (*json)["run"]["dt"].is_number()) {
      config_.dt_ms = (*json)["run"]["dt"].get<double>();
    }
    spikes(*json, manifest);
    const std::string network = text_member(*json, "network");
    return network.empty() || !circuit_path_.empty() || read(manifest.path(network), error);
  }

  void networks(const Json& json, const Manifest& manifest, const std::string& path) {
    if (!json.contains("networks") || !json["networks"].is_object()) {
      return;
    }
    circuit_path_ = path;
    for (const auto& [kind, files] :
         {std::pair{std::string("node"), &config_.nodes}, std::pair{std::string("edge"), &config_.edges}}) {
      if (!json["networks"].contains(kind + "s") || !json["networks"][kind + "s"].is_array()) {
        continue;
      }
      for (const Json& entry : json["networks"][kind + "s"]) {
        const std::string data = text_member(entry, (kind + "s_file").c_str());
        const std::string types = text_member(entry, (kind + "_types_file").c_str());
        if (!data.empty()) {
          files->push_back({manifest.path(data), types.empty() ? "" : manifest.path(types)});
        }
      }
    }
  }

  void spikes(const Json& json, const Manifest& manifest) {
    if (!json.contains("inputs") || !json["inputs"].is_object()) {
      return;
    }
    for (const auto& [name, input] : json["inputs"].items()) {
      const std::string file = text_member(input, "input_file");
      std::string set = text_member(input, "node_set");
      if (input.is_object() && input.contains("node_set") && input["node_set"].is_object()) {
        set = text_member(input["node_set"], "population");
      }
      if (!file.empty() && !set.empty()) {
        config_.spike_files[set] = manifest.path(file);
      }
    }
  }

  SonataConfig config_;
  std::string circuit_path_;
};

/// "x_nodes.h5" -> "x_node_types.csv", where that is there.
std::string types_beside(const std::string& data, const std::string& kind) {
  const fs::path path(data);
  std::string stem = path.stem().string();
  const std::size_t at = stem.rfind(kind + "s");
  if (at == std::string::npos) {
    return "";
  }
  const fs::path types = path.parent_path() / (stem.replace(at, kind.size() + 1, kind + "_types") + ".csv");
  std::error_code ignored;
  return fs::exists(types, ignored) ? types.string() : "";
}

}  // namespace

std::optional<nlohmann::ordered_json> read_json(const std::string& path, std::string& error) {
  const ReadSource source = read_source(path);
  if (!source.ok) {
    error = source.error;
    return std::nullopt;
  }
  Json json = Json::parse(source.file.bytes, nullptr, false, true);
  if (json.is_discarded()) {
    error = path + ": is no JSON";
    return std::nullopt;
  }
  return json;
}

std::optional<SonataConfig> read_sonata_config(const std::string& path, std::string& error) {
  return ConfigReader().run(path, error);
}

std::optional<SonataConfig> sonata_config_of_files(const std::vector<std::string>& paths, std::string& error) {
  SonataConfig config;
  for (const std::string& path : paths) {
    const auto file = Hdf5Reader::open(path, error);
    if (!file) {
      return std::nullopt;
    }
    const bool has_nodes = file->has("/nodes");
    if (!has_nodes && !file->has("/edges")) {
      error = path + ": has neither /nodes nor /edges, so it is no SONATA network";
      return std::nullopt;
    }
    (has_nodes ? config.nodes : config.edges).push_back({path, types_beside(path, has_nodes ? "node" : "edge")});
  }
  if (config.nodes.empty()) {
    error = "none of these files has /nodes";
    return std::nullopt;
  }
  return config;
}

std::optional<std::string> SonataTable::field(std::size_t row, const std::string& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) {
    return std::nullopt;
  }
  const std::string& text = rows[row][static_cast<std::size_t>(found - columns.begin())];
  return text == "NULL" || text.empty() ? std::nullopt : std::optional(text);
}

std::optional<double> SonataTable::number(std::size_t row, const std::string& column) const {
  const auto text = field(row, column);
  double value = 0;
  if (!text || std::from_chars(text->data(), text->data() + text->size(), value).ec != std::errc{}) {
    return std::nullopt;
  }
  return value;
}

std::optional<SonataTable> read_sonata_table(const std::string& path, std::string& error) {
  const ReadSource source = read_source(path);
  if (!source.ok) {
    error = source.error;
    return std::nullopt;
  }
  SonataTable table;
  std::istringstream lines(source.file.bytes);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::vector<std::string> fields;
    for (std::size_t at = line.find_first_not_of(" \t\r"); at < line.size(); at = line.find_first_not_of(" \t\r", at)) {
      const bool is_quoted = line[at] == '"';
      const std::size_t end = is_quoted ? line.find('"', at + 1) : line.find_first_of(" \t\r", at);
      fields.push_back(line.substr(at + (is_quoted ? 1 : 0), end - at - (is_quoted ? 1 : 0)));
      at = end == std::string::npos ? line.size() : end + (is_quoted ? 1 : 0);
    }
    if (fields.empty()) {
      continue;
    }
    if (table.columns.empty()) {
      table.columns = std::move(fields);
    } else if (fields.size() == table.columns.size()) {
      table.rows.push_back(std::move(fields));
    } else {
      error = fmt::format("{}:{}: the row has {} columns, the first line has {}", path, number, fields.size(),
                          table.columns.size());
      return std::nullopt;
    }
  }
  return table;
}

}  // namespace tectum
