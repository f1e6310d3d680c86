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
struct ForeignValue {
  std::vector<double> numbers;
  std::string unit;  // as expressions write it
  friend bool operator==(const ForeignValue&, const ForeignValue&) = default;
};

/// One side of a population, or all of one that lies on no axis.
struct ForeignSide {
  std::vector<std::string> sides;  // one an axis: "left"
  std::map<std::string, ForeignValue> parameters;
};

struct ForeignReceptor {
  std::string name;
  std::string kind;    // "exponential", "instantaneous", "boxcar"
  double time_ms = 0;  // time constant or window
};

struct ForeignPopulation {
  std::string name;
  std::string model;
  std::vector<ForeignReceptor> receptors;
  std::uint32_t size = 0;         // of each side
  std::vector<std::string> axes;  // by name
  std::vector<ForeignSide> sides;
  std::vector<double> spike_times_ms;                              // of a spike_list
  nlohmann::ordered_json more = nlohmann::ordered_json::object();  // nucleus, input, mixed_signs
};

struct ForeignProjection {
  std::string name;
  std::string from, to;  // "EBN.left"
  std::string receptor;  // empty: by sign
  bool is_inhibitory = false;
  std::string weight_unit;
  std::vector<std::uint32_t> pre, post;
  std::vector<double> weight;  // magnitudes
  std::vector<double> delay_ms;
};

struct ForeignCircuit {
  std::string name;
  std::string about;
  double tick_ms = 0.1;
  /// Members of a circuit file that go in as they are: axes, models, inputs, outputs, ...
  nlohmann::ordered_json rest = nlohmann::ordered_json::object();
  std::vector<ForeignPopulation> populations;
  std::vector<ForeignProjection> projections;
  std::vector<std::string> silenced;  // "OPN", "EBN.left"
  std::vector<std::string> warnings;

  [[nodiscard]] std::size_t synapse_count() const {
    std::size_t count = 0;
    for (const ForeignProjection& projection : projections) {
      count += projection.pre.size();
    }
    return count;
  }
};

/// Letters, digits and `_`, not beginning with a digit.
[[nodiscard]] std::string circuit_name_of(const std::string& text);

/// Writes the circuit file `path`, and one edge list a projection in a folder beside it, `a.json` -> `a_wiring/`.
/// Returns one line when something cannot be written.
[[nodiscard]] std::string write_foreign_circuit(const ForeignCircuit& circuit, const std::string& path,
                                                const ExchangeProgress& progress);

}  // namespace tectum
