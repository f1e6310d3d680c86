// Yardsticks of eyes and of the neurons that move them, measured in a circuit's own spikes.
//
// Movements are those that the motoneurons' spikes would give a human eye (tools/evaluate/eye_plant.h), at 500 Hz, not
// those of the servos: an AX-12A turns at 354 deg/s at most and cannot follow the main sequence above 5 to 15 deg. A
// saccade counts from 40 deg/s, or six standard deviations of the spiking noise (Engbert & Kliegl), so that corrections
// of a degree can be missed. A pool's rate is the mean of all its neurons, recruited or not, whereas the published
// slopes are those of single recruited ones.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/analysis/simulated_run.h"
#include "tools/evaluate/protocol.h"

namespace tectum {

struct Yardstick {
  std::string what;
  std::string unit;
  std::optional<double> value;  // nothing: the circuit has no such population, or too few events
  double low = 0, high = 0;     // passes within [low, high]
  std::string source;
  [[nodiscard]] bool passes() const { return value && *value >= low && *value <= high; }
};

/// Deterministic in image and protocol.
[[nodiscard]] std::vector<Yardstick> physiology(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                                const std::function<void(double)>& progress);

/// Ends in a newline.
[[nodiscard]] std::string physiology_text(const Protocol& protocol, const std::vector<Yardstick>& yardsticks);
/// Does not end in a newline.
[[nodiscard]] std::string physiology_json(const Protocol& protocol, const std::string& circuit,
                                          const std::vector<Yardstick>& yardsticks);

}  // namespace tectum
