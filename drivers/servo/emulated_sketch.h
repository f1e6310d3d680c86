// The 2020 head with its own ArbotiX program, as seen from its serial port (sketch_line.h). It hangs as the real one
// does.
#pragma once

#include <array>
#include <deque>
#include <string>

#include "drivers/servo/ax12_motion.h"
#include "drivers/servo/emulated_device.h"
#include "drivers/servo/sketch_line.h"

namespace tectum {

class EmulatedSketch final : public EmulatedDevice {
 public:
  void receive(TimeNs now_ns, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] TimeNs next_ns() const override;
  [[nodiscard]] std::size_t transmit(TimeNs now_ns, std::span<std::uint8_t> out) override;
  void set_line_baud(std::uint32_t baud) override { host_baud_ = baud; }

  /// It waits for a place that it does not go to, and hears nothing any more.
  [[nodiscard]] bool is_hung() const noexcept { return is_hung_; }
  [[nodiscard]] std::uint64_t lines() const noexcept { return lines_; }
  /// The longest that the neck has kept the eyes waiting.
  [[nodiscard]] TimeNs longest_neck_move_ns() const noexcept { return longest_neck_move_ns_; }
  [[nodiscard]] double position_units(Joint joint, TimeNs now_ns) noexcept;

 private:
  struct OutgoingByte {
    TimeNs end_ns;
    std::uint8_t value;
  };
  void obey(const std::string& line);
  void walk_neck(std::size_t field, int goal_units);
  void drive(std::size_t field, int goal_units);
  void answer();

  std::array<Ax12Motion, sketch::kFields> motions_;  // in the line's order
  std::array<int, sketch::kFields> goal_units_ = {512, 512, 512, 512, 512, 512};
  std::deque<OutgoingByte> outgoing_;
  std::string line_;
  std::uint32_t host_baud_ = sketch::kBaud;
  TimeNs busy_until_ns_ = 0;
  TimeNs host_end_ns_ = 0;
  bool is_hung_ = false;
  std::uint64_t lines_ = 0;
  TimeNs longest_neck_move_ns_ = 0;
};

}  // namespace tectum
