// One connection to the head's servos, driven from one thread: commands out, measurements in.
#pragma once

#include "runtime/ports/servo_command.h"

namespace tectum {

enum class ExchangeStatus : std::uint8_t {
  Busy,       // there is more to ask in this round
  RoundOver,  // every servo has been asked
  LinkGone,
};

class ServoExchange {
 public:
  ServoExchange() = default;
  ServoExchange(const ServoExchange&) = delete;
  ServoExchange& operator=(const ServoExchange&) = delete;
  virtual ~ServoExchange() = default;

  /// Finds the servos and gets them ready. LinkGone, or RoundOver even when servos are missing: they may still come.
  [[nodiscard]] virtual ExchangeStatus begin() = 0;
  /// Sends the goals. LinkGone or Busy.
  [[nodiscard]] virtual ExchangeStatus send(const ServoCommand& command) = 0;
  /// One short step of asking, so that a command that comes in between does not wait long.
  [[nodiscard]] virtual ExchangeStatus poll() = 0;
  /// Torque off, as surely as the link allows.
  virtual void release() = 0;
};

}  // namespace tectum
