#pragma once

#include "runtime/ports/servo_command.h"

namespace tectum {

/// The six servos. Receives angles that it can send as they are: the guard has already decided
/// what is safe. Real-time safe: both calls return at once.
class ServoBus {
 public:
  ServoBus() = default;
  ServoBus(const ServoBus&) = delete;
  ServoBus& operator=(const ServoBus&) = delete;
  virtual ~ServoBus() = default;
  /// False when the command could not be handed over.
  [[nodiscard]] virtual bool write(const ServoCommand& command) noexcept = 0;
  /// The newest measured angles.
  virtual void read(TimeNs now_ns, ServoFeedback& out) noexcept = 0;
};

}  // namespace tectum
