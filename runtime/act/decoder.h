// From spikes to joint angles, as the image's outputs say.
//
//   rate_term   = spikes of the term's neurons in the last window_ticks ticks / size / window       (Hz)
//   Position:     angle      = offset + sum of gain * rate
//   Velocity:   d angle / dt = sum of gain * rate,   angle(0) = offset;  integrated once a tick (Euler)
//   joint       = sum of the angles of the outputs that name it
//
// The window is a boxcar that starts empty: until window_ticks have passed, the rate rises as if the neurons had been
// silent before the run.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "runtime/image/load_image.h"
#include "runtime/ports/servo_command.h"

namespace tectum {

/// Counts spikes over each output's window and turns them into six angles.
class Decoder {
 public:
  /// Not real-time safe.
  explicit Decoder(const SpikeImage& image);
  ~Decoder();
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;

  void reset() noexcept;
  /// Takes one tick's spikes, ascending. Real-time safe.
  void tick(std::span<const NeuronId> spikes) noexcept;
  /// Angles now, before the guard. Joints that no output drives stay at 0. Real-time safe.
  void decode(std::span<double, kJointCount> goal_deg) const noexcept;
  /// Velocity outputs integrate; this tells them what the guard let through, so that the integral
  /// does not wind up against a limit. A joint that only Velocity outputs drive goes on from the
  /// guarded angle. Where Position outputs add to it, at most what was integrated since the last
  /// call is taken back, because a slewed Position output is no reason to move the integral.
  /// A guarded angle that is no number changes nothing. Real-time safe.
  void accept(std::span<const double, kJointCount> guarded_deg) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
