// A serial device: 8N1, raw, any baud rate the kernel takes, low latency where it has that.
#pragma once

#include <memory>
#include <string>

#include "drivers/servo/byte_link.h"

namespace tectum {

/// Works on a pseudo-terminal too, which ignores the baud rate. Time is CLOCK_MONOTONIC. Not real-time safe.
class SerialPort final : public ByteLink {
 public:
  /// Null with one clear line in `error`: the device is missing, busy, not permitted, or takes no such rate. The device
  /// is locked (flock), so that two programs do not talk at once.
  [[nodiscard]] static std::unique_ptr<SerialPort> open(const std::string& path, std::uint32_t baud,
                                                        std::string& error);
  ~SerialPort() override;

  [[nodiscard]] bool write(std::span<const std::uint8_t> bytes) noexcept override;
  [[nodiscard]] LinkRead read(std::span<std::uint8_t> out, std::size_t& count, TimeNs deadline_ns) noexcept override;
  void discard_input() noexcept override;
  [[nodiscard]] TimeNs now_ns() noexcept override;
  void sleep_until(TimeNs when_ns) noexcept override;

  /// Whether the driver took ASYNC_LOW_LATENCY. Without it an FTDI chip may keep an answer for 16 ms.
  [[nodiscard]] bool is_low_latency() const noexcept { return is_low_latency_; }

 private:
  explicit SerialPort(int file) noexcept : file_(file) {}

  int file_;
  bool is_low_latency_ = false;
};

}  // namespace tectum
