#pragma once

#include <string>

#include "tools/exchange/wiring.h"

namespace tectum {

/// One row a synapse (pre, post, weight, unit, delay_ms, receptor, projection) in `path`, and one row a cell in a file
/// beside it, `edges.csv` -> `edges_cells.csv`.
[[nodiscard]] ExportReport export_edges(const Wiring& wiring, const std::string& path,
                                        const ExchangeProgress& progress);

/// Where export_edges() puts the cells.
[[nodiscard]] std::string cells_path(const std::string& edges_path);

}  // namespace tectum
