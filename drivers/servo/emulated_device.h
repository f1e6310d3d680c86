// Whatever an emulated serial port leads to. Time is handed in, so that it may be virtual.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "runtime/ports/frame.h"

namespace tectum {

class EmulatedDevice {
 public:
  static constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();

  EmulatedDevice() = default;
  EmulatedDevice(const EmulatedDevice&) = delete;
  EmulatedDevice& operator=(const EmulatedDevice&) = delete;
  virtual ~EmulatedDevice() = default;

  /// The host starts to send these bytes at `now_ns`.
  virtual void receive(TimeNs now_ns, std::span<const std::uint8_t> bytes) = 0;
  /// When the next byte for the host will have arrived; kNever when none is on its way.
  [[nodiscard]] virtual TimeNs next_ns() const = 0;
  /// The bytes that have arrived at the host by `now_ns`; returns how many.
  [[nodiscard]] virtual std::size_t transmit(TimeNs now_ns, std::span<std::uint8_t> out) = 0;
  /// The rate that the host's end of the line is set to.
  virtual void set_line_baud(std::uint32_t baud) = 0;
};

}  // namespace tectum
