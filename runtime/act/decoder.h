// From spikes to joint angles, as the image's outputs say.
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
  /// does not wind up against a limit. Real-time safe.
  void accept(std::span<const double, kJointCount> guarded_deg) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
