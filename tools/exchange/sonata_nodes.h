// The nodes of a SONATA network as cells with Tectum's models.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/exchange/foreign_circuit.h"
#include "tools/exchange/sonata_config.h"

namespace tectum {

/// Nodes that become one side of one population.
struct SonataCells {
  std::string name;  // "EBN.left"
  std::string node_population;
  std::string model;  // Tectum's
  std::vector<ForeignReceptor> receptors;
  std::map<std::string, ForeignValue> parameters;
  std::vector<double> spike_times_ms;  // the same for all of them
  std::uint32_t size = 0;
  double weight_scale = 1;  // the file's weight = weight * weight_scale
  bool is_own = false;      // written by `tectum export`
};

/// Where a node went.
struct SonataPlace {
  std::uint32_t cells = 0;  // index
  std::uint32_t index = 0;  // among them
};

struct SonataNodes {
  std::vector<SonataCells> cells;
  std::map<std::string, std::vector<SonataPlace>> places;                  // by node population, by row
  std::map<std::string, std::map<std::int64_t, std::uint32_t>> row_of_id;  // where ids are not the rows
  std::vector<std::string> warnings;
};

[[nodiscard]] std::optional<SonataNodes> read_sonata_nodes(const SonataConfig& config, double tick_ms,
                                                           std::string& error);

}  // namespace tectum
