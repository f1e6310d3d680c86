// A run as a few numbers, equal if and only if every spike, every state and every count is. Header only,
// so that it can be compiled together with another build of the engine.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "runtime/engine/spike_engine.h"

namespace tectum::test {

struct RunDigest {
  std::uint64_t raster = 0;
  std::uint64_t states = 0;
  std::uint64_t spikes = 0;
  std::uint64_t synaptic_events = 0;
  std::uint64_t dropped_rows = 0;
  friend bool operator==(const RunDigest&, const RunDigest&) = default;
};

/// Words taken in one after the other: FNV-1a over 64-bit words, with a rotation to move the high bits.
class WordDigest {
 public:
  void add(std::uint64_t word) noexcept { value_ = std::rotl((value_ ^ word) * 0x100000001B3ULL, 23); }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325ULL;
};

/// Runs `ticks` ticks, with spikes and input injected from outside now and then, either tick by tick or as
/// many at once as the engine likes. `plan` chooses when and where.
inline RunDigest run_digest(const SpikeImage& image, const EngineOptions& options, std::uint64_t ticks,
                            std::uint64_t plan, bool tick_by_tick) {
  constexpr std::uint32_t kProbedColumns = 4;
  SpikeEngine engine(image, options);
  WordDigest raster;
  std::uint64_t random = plan | 1U;
  const auto draw = [&random](std::uint64_t below) {
    random ^= random << 13U;
    random ^= random >> 7U;
    random ^= random << 17U;
    return random % below;
  };
  while (engine.tick() < ticks) {
    const std::uint64_t stop = std::min(ticks, engine.tick() + 1 + draw(40));
    if (draw(3) == 0) {
      engine.inject_spike(NeuronId{static_cast<std::uint32_t>(draw(image.header.neuron_count))});
    }
    if (image.header.slot_count > 0 && draw(3) == 0) {
      engine.inject_input(SlotId{static_cast<std::uint32_t>(draw(image.header.slot_count))}, 5.0);
    }
    while (engine.tick() < stop) {
      const std::uint64_t first = engine.tick();
      const std::uint32_t done = engine.advance(tick_by_tick ? 1 : stop - first);
      for (std::uint32_t k = 0; k < done; ++k) {
        for (const NeuronId neuron : engine.spikes(k)) {
          raster.add((first + k) << 32U | static_cast<std::uint32_t>(neuron));
        }
      }
    }
  }
  WordDigest states;
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    for (std::uint32_t column = 0; column < kProbedColumns; ++column) {
      states.add(std::bit_cast<std::uint64_t>(engine.probe(NeuronId{neuron}, column)));
    }
  }
  const EngineCounters& counters = engine.counters();
  return {raster.value(), states.value(), counters.spikes, counters.synaptic_events, counters.dropped_rows};
}

}  // namespace tectum::test
