// A circuit as a graph of NIR, the neuromorphic intermediate representation: Pedersen et al. 2024,
// doi:10.1038/s41467-024-52259-9. Times are in s, potentials in mV, currents in nA.
//
//   lif_exp     one time constant of its receptors: CubaLIF. Several: LIF, and an LI for each receptor before it
//   lif_delta   LIF
//   threshold   Threshold, where its receptors are instantaneous and it has no refractory time
//   sources     Input; populations that outputs read (else those that reach no other) lead to an Output
//   pathways    Linear, one a delay, after a Delay
// A constant current is part of v_leak. What NIR lacks is refused, or, where it leaves the equations as they are,
// named.
#pragma once

#include <string>

#include "tools/exchange/wiring.h"

namespace tectum {

[[nodiscard]] ExportReport export_nir(const Wiring& wiring, const std::string& path, const ExchangeProgress& progress);

}  // namespace tectum
