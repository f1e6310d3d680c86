// Runs a recording's input through its circuit again and compares every spike and command.
//
// The input is what RecordedFrame keeps: the active fields of each turn, and what the guard was told. The ticks of a
// turn follow from the turns' own first ticks, so that a recording that a killed process left is replayed up to its
// last whole frame. Weights that learned while it ran learn again, by the rewards of the same fields.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "runtime/engine/spike_engine.h"
#include "runtime/record/recording.h"

namespace tectum {

struct ReplayOptions {
  EngineOptions engine;
  /// Runs the input through a circuit that is not the recorded one, as far as its populations are the same by name and
  /// size: the answer is then where it first does something else.
  bool takes_other_circuit = false;
  std::function<void(double)> progress = {};  // called with 0..1 now and then; may be empty
};

struct ReplayResult {
  std::string error;  // one line when the recording cannot have come from the image; else empty
  bool is_other_circuit = false;
  std::uint64_t frames = 0;
  std::uint64_t spikes = 0;    // of the replay
  std::uint64_t commands = 0;  // frames that sent one
  std::uint64_t learned = 0;   // weights that have changed
  bool is_same = false;
  std::string difference;  // the first, one line
};

/// Not real-time safe.
[[nodiscard]] ReplayResult replay(const SpikeImage& image, const Recording& recording,
                                  const ReplayOptions& options = {});

}  // namespace tectum
