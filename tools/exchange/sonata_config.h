// The files that make up a SONATA network, found through its configuration.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tectum {

/// A node or edge file with its types; the table may be missing.
struct SonataFile {
  std::string data;   // .h5
  std::string types;  // .csv, or empty
};

struct SonataConfig {
  std::vector<SonataFile> nodes;
  std::vector<SonataFile> edges;
  std::string point_neuron_models_dir;
  std::string synaptic_models_dir;
  std::map<std::string, std::string> spike_files;  // by node set
  std::optional<double> dt_ms;
  nlohmann::ordered_json rest;  // tectum.json, where there is one
};

/// Reads a circuit configuration, or a simulation's with the circuit that it names. A simulation_config.json beside a
/// circuit_config.json is read as well. Nothing, and one line in `error`, when they cannot be used.
[[nodiscard]] std::optional<SonataConfig> read_sonata_config(const std::string& path, std::string& error);

/// For bare files: nodes and edges told apart by what they hold, types by their names (`x_nodes.h5`,
/// `x_node_types.csv`).
[[nodiscard]] std::optional<SonataConfig> sonata_config_of_files(const std::vector<std::string>& paths,
                                                                 std::string& error);

/// A table of types: columns separated by blanks, fields with blanks in double quotes.
struct SonataTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;

  /// Nothing where the column is missing, or the field is NULL.
  [[nodiscard]] std::optional<std::string> field(std::size_t row, const std::string& column) const;
  [[nodiscard]] std::optional<double> number(std::size_t row, const std::string& column) const;
};
[[nodiscard]] std::optional<SonataTable> read_sonata_table(const std::string& path, std::string& error);

/// A JSON file, comments allowed.
[[nodiscard]] std::optional<nlohmann::ordered_json> read_json(const std::string& path, std::string& error);

}  // namespace tectum
