// A circuit as a SONATA network that NEST and BMTK read: Dai et al. 2020, doi:10.1371/journal.pcbi.1007696.
//
//   circuit_config.json, simulation_config.json, node_sets.json, tectum.json (circuit_rest.h)
//   network/KIND_nodes.h5 and KIND_node_types.csv for each kind of population that there is: NEST takes one model type
//   a
//                                   file. `neuron` holds point neurons, `generator` Poisson sources, `virtual` what
//                                   only Tectum can make fire (retinas) and given spike times
//   network/edges.h5, edge_types.csv     one edge population for each pair of node populations, one edge type a pathway
//   components/point_neuron_models       a file a node type
//   components/synaptic_models           a file a receptor port
//   inputs/spikes.h5                     of the virtual nodes
//
// Columns and datasets that begin with tectum_ hold what NEST's units round, so that an import gets every bit back:
//   node types: tectum_model, tectum_receptors (name:kind:tau_ms or window_ticks, comma between), tectum_tau_m,
//   tectum_R_m, tectum_I_bias, tectum_b_w; edge types: tectum_projection, tectum_receptor; edges: tectum_weight where
//   the weight's scale is no whole number.
#pragma once

#include <string>

#include "compiler/compile.h"
#include "tools/exchange/wiring.h"

namespace tectum {

[[nodiscard]] ExportReport export_sonata(const CompileResult& result, const std::string& folder,
                                         const ExchangeProgress& progress);

}  // namespace tectum
