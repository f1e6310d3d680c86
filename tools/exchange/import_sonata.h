// A SONATA network as a circuit. What `tectum export --to sonata` wrote comes back bit for bit; another network becomes
// one population a node type.
#pragma once

#include <optional>
#include <string>

#include "tools/exchange/foreign_circuit.h"
#include "tools/exchange/sonata_config.h"

namespace tectum {

struct SonataImportOptions {
  std::optional<double> tick_ms;  // instead of the simulation's dt
};

/// Nothing, and one line in `error`, when the network is damaged or has neurons that Tectum has no model of.
[[nodiscard]] std::optional<ForeignCircuit> import_sonata(const SonataConfig& config,
                                                          const SonataImportOptions& options, std::string& error,
                                                          const ExchangeProgress& progress);

}  // namespace tectum
