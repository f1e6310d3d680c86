// A network and its stimulus as plain arrays, for another simulator to run the very same.
#pragma once

#include <string>

#include "tools/benchmark/floor.h"

namespace tectum {

/// Writes into `folder`: pre.u32, post.u32 (neurons), weight.f64 (the receptor's unit), receptor.u32,
/// delay_ticks.u32, initial.f64 (V_init in mV; 0 for sources), stimulus_tick.u32 and stimulus_neuron.u32,
/// and what the engine fires: spike_tick.u32 and spike_neuron.u32; each little-endian without a header. Returns an
/// error, or nothing.
[[nodiscard]] std::string export_network(const SpikeImage& image, const Stimulus& stimulus, const Stimulus& raster,
                                         const std::string& folder);

}  // namespace tectum
