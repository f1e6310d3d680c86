// A circuit that was read from another format, on its way to a circuit file and its edge lists.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/exchange/wiring.h"

namespace tectum {

/// One number for all neurons, or one a neuron.
struct ImportedValue {
  std::vector<double> numbers;
  std::string unit;  // as expressions write it
  friend bool operator==(const ImportedValue&, const ImportedValue&) = default;
};

/// One side of a population, or all of one that lies on no axis.
struct ImportedSide {
  std::vector<std::string> sides;  // one an axis: "left"
  std::map<std::string, ImportedValue> parameters;
};

struct ImportedReceptor {
  std::string name;
  std::string kind;    // "exponential", "instantaneous", "boxcar"
  double time_ms = 0;  // time constant or window
};

struct ImportedPopulation {
  std::string name;
  std::string model;
  std::vector<ImportedReceptor> receptors;
  std::uint32_t size = 0;         // of each side
  std::vector<std::string> axes;  // by name
  std::vector<ImportedSide> sides;
  std::vector<double> spike_times_ms;                              // of a spike_list
  nlohmann::ordered_json more = nlohmann::ordered_json::object();  // nucleus, input, mixed_signs
};

struct ImportedProjection {
  std::string name;
  std::string from, to;  // "EBN.left"
  std::string receptor;  // empty: by sign
  bool is_inhibitory = false;
  std::string weight_unit;
  std::vector<std::uint32_t> pre, post;
  std::vector<double> weight;  // magnitudes
  std::vector<double> delay_ms;
};

struct ImportedCircuit {
  std::string name;
  std::string about;
  double tick_ms = 0.1;
  /// Members of a circuit file that go in as they are: axes, models, inputs, outputs, ...
  nlohmann::ordered_json rest = nlohmann::ordered_json::object();
  std::vector<ImportedPopulation> populations;
  std::vector<ImportedProjection> projections;
  std::vector<std::string> silenced;  // "OPN", "EBN.left"
  std::vector<std::string> warnings;

  [[nodiscard]] std::size_t synapse_count() const {
    std::size_t count = 0;
    for (const ImportedProjection& projection : projections) {
      count += projection.pre.size();
    }
    return count;
  }
};

/// Letters, digits and `_`, not beginning with a digit.
[[nodiscard]] std::string circuit_name_of(const std::string& text);

/// Writes the circuit file `path`, and one edge list a projection in a folder beside it, `a.json` -> `a_wiring/`.
/// Returns one line when something cannot be written.
[[nodiscard]] std::string write_imported_circuit(const ImportedCircuit& circuit, const std::string& path,
                                                 const ExchangeProgress& progress);

}  // namespace tectum
