#pragma once

#include "runtime/ports/frame.h"

namespace tectum {

enum class CameraStatus {
  NewFrame,    // `out` holds a frame not delivered before
  NoNewFrame,  // `out` is untouched: nothing newer than the last read
  Ended,       // a recording is over
  Failed,      // the device is gone; the driver keeps the reason
};

/// One eye. Real-time safe: takes the newest frame that is there and never waits.
class Camera {
 public:
  Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;
  virtual ~Camera() = default;
  [[nodiscard]] virtual CameraStatus read(TimeNs now_ns, Frame& out) noexcept = 0;
};

}  // namespace tectum
