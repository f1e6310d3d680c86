// A half-duplex bus of emulated AX-12As, with the timing of the real one (Xevel, "USB2AX: Dynamixel protocol notes"):
// ten bits a byte, the return delay, and a motor-control interrupt each millisecond that holds the servo's transmitter
// up for 130 us, so that answers jitter and gaps open inside them.
//
// Two that talk at once spoil each other's bytes, as on the wire: two servos with one ID, or a host that does not wait.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "drivers/servo/ax12_motion.h"
#include "drivers/servo/emulated_device.h"
#include "drivers/servo/emulated_servo.h"
#include "drivers/servo/packet_parser.h"
#include "drivers/servo/wire_noise.h"

namespace tectum {

struct EmulatorOptions {
  std::uint64_t seed = 1;  // of the noise and of the interrupts' phases
  bool has_timing = true;  // without it every answer is there at once
};

struct EmulatorCounters {
  std::uint64_t instructions = 0;  // whole ones, as the servos heard them
  std::uint64_t answers = 0;
  std::uint64_t bad_checksums = 0;
  std::uint64_t collided_bytes = 0;
};

class Ax12Emulator final : public EmulatedDevice {
 public:
  explicit Ax12Emulator(const EmulatorOptions& options = {});

  /// With the emulator's own motion.
  EmulatedServo& add_servo(std::uint8_t id, const Ax12MotionParams& motion = {});
  /// With any other.
  EmulatedServo& add_servo(std::uint8_t id, std::unique_ptr<ServoMotion> motion);

  void receive(TimeNs now_ns, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] TimeNs next_ns() const override;
  [[nodiscard]] std::size_t transmit(TimeNs now_ns, std::span<std::uint8_t> out) override;
  /// Servos of another rate hear nothing.
  void set_line_baud(std::uint32_t baud) override;

  // The world. Servos are found by the ID that they have now; null when there is none.
  [[nodiscard]] EmulatedServo* find(std::uint8_t id) noexcept;
  /// Null when the servo has a motion that is not the emulator's own.
  [[nodiscard]] Ax12Motion* find_motion(std::uint8_t id) noexcept;
  /// Its plug out, and in again: it comes back as after a power cycle. False when there is no such servo.
  bool pull_plug(std::uint8_t id, TimeNs now_ns) noexcept;
  bool plug_in(std::uint8_t id, TimeNs now_ns) noexcept;

  WireNoise noise;  // on both directions
  [[nodiscard]] const EmulatorCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::size_t servo_count() const noexcept { return servos_.size(); }

 private:
  struct BusServo {
    std::unique_ptr<ServoMotion> motion;
    Ax12Motion* own_motion = nullptr;
    std::unique_ptr<EmulatedServo> servo;
    TimeNs interrupt_phase_ns = 0;
    bool is_unplugged = false;
  };
  struct OutgoingByte {
    TimeNs start_ns, end_ns;
    std::uint8_t value;
  };

  EmulatedServo& add(BusServo servo, std::uint8_t id);
  void hear(TimeNs byte_start_ns, std::uint8_t byte) noexcept;
  void obey(const dynamixel::Packet& instruction, TimeNs end_ns) noexcept;
  void report_bad_checksum(std::uint8_t id, TimeNs end_ns) noexcept;
  void send(const BusServo& from, const EmulatedServo::Reaction& reaction, TimeNs end_ns) noexcept;
  void put_on_wire(OutgoingByte byte) noexcept;
  [[nodiscard]] bool hears(const BusServo& servo, TimeNs now_ns) const noexcept;

  EmulatorOptions options_;
  std::vector<BusServo> servos_;
  dynamixel::PacketParser parser_{dynamixel::PacketKind::Instruction};
  std::deque<OutgoingByte> outgoing_;  // by start
  double line_baud_ = 1e6;
  TimeNs byte_ns_ = 10'000;
  TimeNs host_end_ns_ = 0;  // end of the last byte from the host
  bool has_heard_bad_ = false;
  std::uint8_t bad_id_ = 0;
  EmulatorCounters counters_;
};

}  // namespace tectum
