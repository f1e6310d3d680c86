// Timed runs of the engine, of the floor, and of the circuit that sees.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/engine/spike_engine.h"
#include "tools/benchmark/floor.h"

namespace tectum {

struct Timing {
  double seconds = 0;       // processor time of the calling thread
  double wall_seconds = 0;  // what counts where several threads run
  std::uint64_t spikes = 0;
  std::uint64_t synaptic_events = 0;
  double step_median_us = 0;  // wall time of one read-out step, where there are any
  double step_99th_us = 0;
};

struct RunPlan {
  std::uint64_t ticks = 0;
  std::uint32_t ticks_a_step = 0;  // spikes are read out after so many ticks; 0: as the engine likes
};

[[nodiscard]] Timing time_engine(const SpikeImage& image, const EngineOptions& options, const RunPlan& plan);

enum class FloorKind { Dense, Silent };
[[nodiscard]] Timing time_floor(Floor& floor, FloorKind kind, const Stimulus& stimulus, const RunPlan& plan);

/// What an eye saw, to be shown to the engine again: which fields change when.
struct SeenRun {
  struct Change {
    std::uint64_t tick;
    NeuronId neuron;
    bool is_active;
  };
  std::vector<Change> changes;
  std::uint64_t ticks = 0;
};

/// The circuit in the simulated head, following a dot that jumps and moves; keeps what it saw.
[[nodiscard]] SeenRun see_moving_target(const SpikeImage& image, double duration_s);
[[nodiscard]] Timing time_seen(const SpikeImage& image, const EngineOptions& options, const SeenRun& seen);
/// Seconds that both eyes' retinas take for one camera frame of `resolution_px` squared, mean over a moving dot.
[[nodiscard]] double time_retinas(const SpikeImage& image, int resolution_px);

/// Of a clock that never jumps.
[[nodiscard]] double wall_seconds();
/// State of the engine in memory, as the system counts it: what building one adds to the process.
[[nodiscard]] std::uint64_t resident_bytes();

}  // namespace tectum
