#pragma once

#include "runtime/ports/frame.h"

namespace tectum {

/// Virtual or monotonic time.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;
  [[nodiscard]] virtual TimeNs now_ns() noexcept = 0;
  /// Absolute, so that lateness never accumulates. Virtual clocks advance the world instead.
  virtual void sleep_until(TimeNs when_ns) noexcept = 0;
};

}  // namespace tectum
