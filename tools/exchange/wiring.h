// A circuit as its explicit cells and synapses in physical units: what every exported format is written from.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compiler/elaborate/network.h"
#include "compiler/expression/dimension.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// Population i of the network is instance i of the circuit.
struct Wiring {
  const Circuit& circuit;
  const Network& network;
};

/// Share done, 0 to 1.
using ExchangeProgress = std::function<void(double)>;

/// What an exporter did: lines for the user, each naming what the format cannot say.
struct ExportReport {
  std::string error;                  // one line; empty when the files are there
  bool is_refused = false;            // the error is the circuit's, not the world's
  std::vector<std::string> warnings;  // without a full stop
};

/// Signed: negative inhibits. Exact: a whole number of quanta of the receptor.
[[nodiscard]] double weight_of(const Network& network, std::size_t synapse);
/// As expressions write it: "nA"; empty for a plain number.
[[nodiscard]] std::string weight_unit(const NetworkPopulation& population, std::uint32_t receptor);
/// Of a built-in model, as given or by default: one value for all neurons, or one a neuron.
[[nodiscard]] std::vector<double> parameter_of(const NetworkPopulation& population, std::string_view name);
/// As expressions write it; empty for a plain number, and for izhikevich, whose coefficients may be written plain.
[[nodiscard]] std::string parameter_unit(const NetworkPopulation& population, std::string_view name);
[[nodiscard]] std::string built_in_parameter_unit(ModelKind model, std::string_view name);
[[nodiscard]] std::string_view model_name(const NetworkPopulation& population);
/// The unit in which the language holds this dimension: "nA", "1/ms", "mV/ms"; empty for a plain number.
[[nodiscard]] std::string coherent_unit(const Dimension& dimension);
/// "EBN.left.3"
[[nodiscard]] std::string cell_name(const NetworkPopulation& population, std::uint32_t index);
/// What follows a number that has this unit: " ms".
[[nodiscard]] std::string unit_text(std::string_view unit);
/// "2 ms": the shortest text that reads back to the same number.
[[nodiscard]] std::string quantity_text(double value, std::string_view unit);

}  // namespace tectum
