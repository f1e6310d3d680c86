// What the circuit is compared with: controllers without neurons, on the same head, guard and target.
#pragma once

#include "tools/analysis/simulated_run.h"
#include "tools/evaluate/protocol.h"

namespace tectum {

enum class ReferenceKind {
  Still,   // the eyes stay where they are
  Oracle,  // knows where the target was when the newest frame was taken, and the head's geometry: the physical limit
  Pid,     // pan and tilt of each eye by its retinal error, free of noise, or by the other eye's
  PidFromPicture  // the same by the middle of the largest lit blob in the camera's picture, lit as the first retina has
                  // it
};

struct ReferenceController {
  ReferenceKind kind = ReferenceKind::Still;
  PidGains pid;
};

/// The image gives the joints' limits and speeds to the guard; nothing of it runs. The neck stays ahead.
/// Deterministic in its arguments.
[[nodiscard]] Recording run_reference(const SpikeImage& image, const SimulatedRunOptions& options,
                                      const ReferenceController& controller);

}  // namespace tectum
