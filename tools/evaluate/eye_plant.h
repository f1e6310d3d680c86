// The movement that the motoneurons would give a human eye.
//
// Each spike of a motoneuron is a twitch, and what orbit and muscle make of it has three poles: 224 and 13 ms
// (Robinson, Gordon & Gordon 1986, doi:10.1007/BF00363977; 150 and 12 ms in Robinson 1973, doi:10.1007/bf00288906) and
// 10 ms of muscle activation (Harris & Wolpert 1998, doi:10.1038/29528):
//
//   E / R = 1 / ((1 + 0.224 s) (1 + 0.013 s) (1 + 0.010 s))
//
// A circuit's outputs are angles for servos that have no orbit to stretch. The slow pole counts as cancelled, as a
// pulse of the right size cancels it in people; left are the fast two, on the spikes themselves:
//
//   13 ms dx/dt = drive - x,   10 ms dy/dt = x - y,   drive = offset + sum of gain * spikes of the tick / size / tick
//
// The window over which an output counts spikes for a camera's frame is no part of an eye and is left out. Velocity
// outputs drive with their integral.
#pragma once

#include <array>
#include <span>

#include "runtime/image/load_image.h"
#include "runtime/record/recording.h"
#include "tools/analysis/gaze_traces.h"

namespace tectum {

inline constexpr std::array<double, 2> kEyePlantPolesS = {0.013, 0.010};
/// By which the eye goes on after a burst.
inline constexpr double kEyePlantLagS = kEyePlantPolesS[0] + kEyePlantPolesS[1];
inline constexpr double kEyeSampleS = 0.002;

/// The fast poles, exact for a drive that holds over a step.
class EyePlant {
 public:
  /// At rest at `start_deg`.
  explicit EyePlant(double step_s, double start_deg = 0);
  /// Where the eye is at the end of a step in which the drive was `drive_deg`.
  double step(double drive_deg);

 private:
  std::array<double, 2> kept_{};  // of each pole's distance from the drive
  double carried_ = 0;            // of the first's distance, into the second
  double muscle_deg_ = 0, eye_deg_ = 0;
};

/// Both eyes in the head, pan and tilt, sample k at k * kEyeSampleS. The recording must hold the image's spikes.
[[nodiscard]] std::array<AngleTrace, kEyeCount> eye_movements(const SpikeImage& image, const Recording& recording);

}  // namespace tectum
