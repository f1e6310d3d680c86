#pragma once

#include <string>

#include "tools/exchange/wiring.h"

namespace tectum {

/// What a node of the graph stands for.
enum class GraphGrain { Cell, Population };

/// A directed multigraph with attributes: http://graphml.graphdrawing.org/specification.html
[[nodiscard]] ExportReport export_graphml(const Wiring& wiring, GraphGrain grain, const std::string& path,
                                          const ExchangeProgress& progress);
/// For Graphviz: `dot -Tsvg`.
[[nodiscard]] ExportReport export_dot(const Wiring& wiring, GraphGrain grain, const std::string& path,
                                      const ExchangeProgress& progress);

}  // namespace tectum
