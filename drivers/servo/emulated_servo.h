// One AX-12A without its wires: registers, instructions, alarms.
//
// From the e-manual: the table of ax12_registers.h, what each instruction does, which are answered at which status
// return level, the error bits, and that an alarm in `shutdown` sets torque_limit to 0 until it is written again. From
// users of the servo (Robotis forum): while torque is off the goal follows the shaft, and writing a goal switches
// torque on. Not documented, so chosen: a value that may not be written refuses its whole instruction with a range
// error; a stall counts as an overload after half a second; the overload bit stays until torque_limit is written.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/servo/ax12_registers.h"
#include "drivers/servo/packet.h"
#include "drivers/servo/servo_motion.h"

namespace tectum {

class EmulatedServo {
 public:
  /// As it leaves the factory but for its ID, with power on. `motion` outlives it.
  EmulatedServo(std::uint8_t id, ServoMotion& motion, TimeNs now_ns) noexcept;

  struct Reaction {
    bool is_answered = false;
    dynamixel::PacketBytes answer;
    TimeNs thinking_ns = 0;  // before the answer starts, the return delay included
  };
  /// `now_ns` is when the last byte of the instruction arrived.
  [[nodiscard]] Reaction obey(const dynamixel::Packet& instruction, TimeNs now_ns) noexcept;
  /// The answer to an instruction that came damaged.
  [[nodiscard]] Reaction report_bad_checksum(TimeNs now_ns) noexcept;

  /// Reads the shaft into the present registers and looks for alarms.
  void update(TimeNs now_ns) noexcept;

  // The world, and a look inside.
  void set_supply_v(double volts) noexcept { supply_v_ = volts; }
  void set_temperature_c(int celsius) noexcept { temperature_c_ = celsius; }
  void power_cycle(TimeNs now_ns) noexcept;
  [[nodiscard]] std::uint16_t get(const ax12::Register& row) const noexcept;
  /// As if written before: no check, no answer.
  void set(const ax12::Register& row, std::uint16_t value, TimeNs now_ns) noexcept;

  [[nodiscard]] std::uint8_t id() const noexcept { return static_cast<std::uint8_t>(get(ax12::kId)); }
  /// Writing the EEPROM blocks it for 6 ms a byte.
  [[nodiscard]] bool is_deaf(TimeNs now_ns) const noexcept { return now_ns < busy_until_ns_; }
  [[nodiscard]] std::uint8_t alarm_bits() const noexcept { return alarm_bits_; }

 private:
  using Bytes = std::span<const std::uint8_t>;
  [[nodiscard]] std::uint8_t execute(const dynamixel::Packet& instruction, TimeNs now_ns) noexcept;
  [[nodiscard]] std::uint8_t check_write(std::uint8_t address, Bytes data) const noexcept;
  void write(std::uint8_t address, Bytes data, TimeNs now_ns) noexcept;
  [[nodiscard]] std::uint8_t write_checked(std::uint8_t address, Bytes data, TimeNs now_ns) noexcept;
  [[nodiscard]] std::uint8_t read(Bytes parameters, std::array<std::uint8_t, ax12::kTableSize>& out,
                                  std::size_t& count) const noexcept;
  [[nodiscard]] std::uint8_t remember(Bytes parameters) noexcept;
  [[nodiscard]] std::uint8_t act(TimeNs now_ns) noexcept;
  [[nodiscard]] std::uint8_t take_share(Bytes parameters, TimeNs now_ns) noexcept;
  void reset_to_factory(TimeNs now_ns) noexcept;
  void load_ram() noexcept;
  void put(const ax12::Register& row, std::uint16_t value) noexcept;
  void drive_motor(TimeNs now_ns) noexcept;
  void watch_for_alarms(const ShaftState& shaft, TimeNs now_ns) noexcept;
  [[nodiscard]] bool is_wheel() const noexcept;

  ServoMotion& motion_;
  std::array<std::uint8_t, ax12::kTableSize> table_{};
  std::array<std::uint8_t, ax12::kTableSize + 1> registered_{};  // address, then data
  std::size_t registered_size_ = 0;
  double supply_v_ = 11.1;
  int temperature_c_ = 30;
  std::uint8_t alarm_bits_ = 0;
  bool is_stalled_ = false;
  TimeNs stalled_since_ns_ = 0;
  TimeNs busy_until_ns_ = 0;
};

}  // namespace tectum
