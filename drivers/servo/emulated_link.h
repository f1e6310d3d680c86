// A cable without a cable: the host and an emulated device in one thread, in virtual time, which a read moves on to the
// next byte or to its deadline. Hours of traffic take seconds.
#pragma once

#include <algorithm>
#include <array>

#include "drivers/servo/byte_link.h"
#include "drivers/servo/emulated_device.h"

namespace tectum {

class EmulatedLink final : public ByteLink {
 public:
  /// `device` outlives it. Time goes on from `start_ns`.
  explicit EmulatedLink(EmulatedDevice& device, TimeNs start_ns = 0) noexcept : device_(device), now_ns_(start_ns) {}

  [[nodiscard]] bool write(std::span<const std::uint8_t> bytes) noexcept override {
    if (is_unplugged_) {
      return false;
    }
    device_.receive(now_ns_, bytes);
    return true;
  }
  [[nodiscard]] LinkRead read(std::span<std::uint8_t> out, std::size_t& count, TimeNs deadline_ns) noexcept override {
    count = 0;
    if (is_unplugged_) {
      return LinkRead::Gone;
    }
    const TimeNs next_ns = device_.next_ns();
    if (next_ns > deadline_ns) {
      now_ns_ = std::max(now_ns_, deadline_ns);
      return LinkRead::TimedOut;
    }
    now_ns_ = std::max(now_ns_, next_ns);
    count = device_.transmit(now_ns_, out);
    return LinkRead::Bytes;
  }
  void discard_input() noexcept override {
    std::array<std::uint8_t, 64> unwanted;
    while (device_.transmit(now_ns_, unwanted) > 0) {
    }
  }
  [[nodiscard]] TimeNs now_ns() noexcept override { return now_ns_; }
  void sleep_until(TimeNs when_ns) noexcept override { now_ns_ = std::max(now_ns_, when_ns); }

  /// The adapter's plug: every call fails from now on.
  void unplug() noexcept { is_unplugged_ = true; }

 private:
  EmulatedDevice& device_;
  TimeNs now_ns_;
  bool is_unplugged_ = false;
};

}  // namespace tectum
