// A circuit as a NeuroML 2 document: https://docs.neuroml.org/Userdocs/NeuroMLv2.html
//
//   lif_exp      IF_curr_exp (cm = tau_m / R_m in nF), a component and a population for each set of parameters
//   receptors    expCurrSynapse, one a time constant; a connection's weight is in nA, negative inhibits
//   poisson      spikeGeneratorPoisson;  spike_list  spikeArray;  retinas  a spikeArray without spikes
// Other models have no counterpart among NeuroML's own and are refused by name.
#pragma once

#include <string>

#include "tools/exchange/wiring.h"

namespace tectum {

[[nodiscard]] ExportReport export_neuroml(const Wiring& wiring, const std::string& path,
                                          const ExchangeProgress& progress);

}  // namespace tectum
