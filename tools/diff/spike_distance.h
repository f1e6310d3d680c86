// Distances between two spike trains: times in ms, ascending.
#pragma once

#include <span>

namespace tectum {

/// Sqrt of (1/tau) integral (f - g)^2 dt, where each spike adds exp(-(t - t_k)/tau) from t_k on: a lone spike against
/// none is sqrt(1/2), two spikes far apart are 1.
/// van Rossum 2001, Neural Computation 13:751, doi:10.1162/089976601300014321.
[[nodiscard]] double van_rossum_distance(std::span<const double> a_ms, std::span<const double> b_ms, double tau_ms);

/// Least cost of turning one train into the other: 1 for each spike put in or taken out, `cost_per_ms` for each
/// millisecond that a spike is moved.
/// Victor & Purpura 1996, J Neurophysiol 76:1310, doi:10.1152/jn.1996.76.2.1310.
[[nodiscard]] double victor_purpura_distance(std::span<const double> a_ms, std::span<const double> b_ms,
                                             double cost_per_ms);

/// Mean over [begin, end) of the SPIKE dissimilarity profile, in [0, 1], exact: the profile is integrated piece by
/// piece. Needs: begin_ms < end_ms, spikes within both. Kreuz, Chicharro, Houghton, Andrzejak & Mormann 2013,
/// J Neurophysiol 109:1457, doi:10.1152/jn.00873.2012; what happens before the first and after the last spike of a
/// train as in its authors' SPIKY and PySpike: Kreuz, Mulansky & Bozanic 2015, J Neurophysiol 113:3432,
/// doi:10.1152/jn.00848.2014.
[[nodiscard]] double spike_distance(std::span<const double> a_ms, std::span<const double> b_ms, double begin_ms,
                                    double end_ms);

}  // namespace tectum
