// An ArbotiX-M with the `ros` firmware between the host and an emulated bus, with what that firmware leaves out
// (vanadiumlabs/arbotix_ros, ros.ino, read for its behaviour):
//   - PING, REG_WRITE and ACTION for a servo are swallowed without an answer;
//   - WRITE passes one or two data bytes, drops the rest, and is always answered with no error;
//   - READ is passed; a servo that is silent gives silence;
//   - SYNC_READ (84) asks servo after servo and gives FF bytes for one that is silent;
//   - everything else for everybody goes out raw, with one stale byte behind it;
//   - a damaged packet is answered with the checksum bit.
#pragma once

#include <deque>

#include "drivers/servo/ax12_emulator.h"

namespace tectum {

class EmulatedArbotix final : public EmulatedDevice {
 public:
  static constexpr std::uint8_t kBoardId = 253;
  static constexpr std::uint16_t kBoardModel = 300;
  static constexpr std::uint32_t kHostBaud = 115200;

  /// `bus` outlives it, and hears from nobody else.
  explicit EmulatedArbotix(Ax12Emulator& bus);

  void receive(TimeNs now_ns, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] TimeNs next_ns() const override;
  [[nodiscard]] std::size_t transmit(TimeNs now_ns, std::span<std::uint8_t> out) override;
  /// At another rate the board hears nothing.
  void set_line_baud(std::uint32_t baud) override { host_baud_ = baud; }

 private:
  struct OutgoingByte {
    TimeNs end_ns;
    std::uint8_t value;
  };
  void act(const dynamixel::Packet& packet);
  void answer_for_board(const dynamixel::Packet& packet);
  void read_from_all(const dynamixel::Packet& packet);
  void pass_write(const dynamixel::Packet& packet);
  /// Moves busy_until_ns_ to the end of the servo's answer, or of the wait for it.
  [[nodiscard]] std::vector<std::uint8_t> ask_bus(const dynamixel::PacketBytes& question);
  void send_on_bus(std::span<const std::uint8_t> bytes);
  void reply(std::span<const std::uint8_t> bytes);

  Ax12Emulator& bus_;
  dynamixel::PacketParser parser_{dynamixel::PacketKind::Instruction};
  std::deque<OutgoingByte> outgoing_;
  std::uint32_t host_baud_ = kHostBaud;
  TimeNs host_end_ns_ = 0;
  TimeNs busy_until_ns_ = 0;
  TimeNs reply_end_ns_ = 0;
};

}  // namespace tectum
