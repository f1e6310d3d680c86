#include "drivers/servo/ax12_emulator.h"

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

using namespace dynamixel;

constexpr double kBitsAByte = 10;        // start, 8, stop
constexpr double kBaudTolerance = 0.03;  // e-manual, "Baud Rate"
constexpr TimeNs kInterruptPeriodNs = 1'000'000;
constexpr TimeNs kInterruptNs = 130'000;
// e-manual, Protocol 1.0, "Byte to Byte Time": after this a servo waits for a new header.
constexpr TimeNs kByteToByteNs = 100'000'000;
// Bits that change when two talk at once. Any; the checksum sees it or the header is gone.
constexpr std::uint8_t kCollision = 0x55;

}  // namespace

Ax12Emulator::Ax12Emulator(const EmulatorOptions& options) : noise(options.seed), options_(options) {
  set_line_baud(1'000'000);
}

EmulatedServo& Ax12Emulator::add_servo(std::uint8_t id, const Ax12MotionParams& motion) {
  BusServo servo;
  auto own = std::make_unique<Ax12Motion>(motion);
  servo.own_motion = own.get();
  servo.motion = std::move(own);
  return add(std::move(servo), id);
}

EmulatedServo& Ax12Emulator::add_servo(std::uint8_t id, std::unique_ptr<ServoMotion> motion) {
  BusServo servo;
  servo.motion = std::move(motion);
  return add(std::move(servo), id);
}

EmulatedServo& Ax12Emulator::add(BusServo servo, std::uint8_t id) {
  servo.servo = std::make_unique<EmulatedServo>(id, *servo.motion, 0);
  servo.interrupt_phase_ns = static_cast<TimeNs>(noise.uniform() * static_cast<double>(kInterruptPeriodNs));
  servos_.push_back(std::move(servo));
  return *servos_.back().servo;
}

void Ax12Emulator::set_line_baud(std::uint32_t baud) {
  if (baud > 0) {
    line_baud_ = baud;
    byte_ns_ = options_.has_timing ? std::llround(1e9 * kBitsAByte / baud) : 0;
  }
}

bool Ax12Emulator::hears(const BusServo& servo, TimeNs now_ns) const noexcept {
  const double own_baud = ax12::baud_of(static_cast<std::uint8_t>(servo.servo->get(ax12::kBaudRate)));
  return !servo.is_unplugged && !servo.servo->is_deaf(now_ns) && std::abs(own_baud / line_baud_ - 1) < kBaudTolerance;
}

void Ax12Emulator::receive(TimeNs now_ns, std::span<const std::uint8_t> bytes) {
  if (now_ns - host_end_ns_ > kByteToByteNs) {
    parser_.clear();
  }
  host_end_ns_ = std::max(host_end_ns_, now_ns);
  for (const std::uint8_t byte : bytes) {
    hear(host_end_ns_, byte);
    host_end_ns_ += options_.has_timing ? byte_ns_ : 0;
  }
  // A servo answers a damaged packet, but not in the middle of the next one.
  if (has_heard_bad_ && parser_.pending_bytes() == 0) {
    report_bad_checksum(bad_id_, host_end_ns_);
  }
  has_heard_bad_ = false;
}

void Ax12Emulator::hear(TimeNs byte_start_ns, std::uint8_t byte) noexcept {
  const TimeNs byte_end_ns = byte_start_ns + byte_ns_;
  for (OutgoingByte& outgoing : outgoing_) {
    if (outgoing.start_ns < byte_end_ns && byte_start_ns < outgoing.end_ns) {
      outgoing.value ^= kCollision;
      byte ^= kCollision;
      ++counters_.collided_bytes;
    }
  }
  noise.pass(byte, [&](std::uint8_t heard) {
    parser_.push(std::span(&heard, 1));
    Packet frame;
    for (;;) {
      const ParseResult result = parser_.next(frame);
      if (result == ParseResult::NeedMore) {
        return;
      }
      if (result == ParseResult::BadChecksum) {
        ++counters_.bad_checksums;
        has_heard_bad_ = true;
        bad_id_ = frame.id;
      } else {
        has_heard_bad_ = false;
        obey(frame, byte_end_ns);
      }
    }
  });
}

void Ax12Emulator::obey(const Packet& instruction, TimeNs end_ns) noexcept {
  ++counters_.instructions;
  for (BusServo& bus_servo : servos_) {
    const bool is_meant = instruction.id == kBroadcastId || instruction.id == bus_servo.servo->id();
    if (!is_meant || !hears(bus_servo, end_ns)) {
      continue;
    }
    const EmulatedServo::Reaction reaction = bus_servo.servo->obey(instruction, end_ns);
    if (reaction.is_answered) {
      send(bus_servo, reaction, end_ns);
    }
  }
}

void Ax12Emulator::report_bad_checksum(std::uint8_t id, TimeNs end_ns) noexcept {
  for (BusServo& bus_servo : servos_) {
    if (bus_servo.servo->id() == id && hears(bus_servo, end_ns)) {
      const EmulatedServo::Reaction reaction = bus_servo.servo->report_bad_checksum(end_ns);
      if (reaction.is_answered) {
        send(bus_servo, reaction, end_ns);
      }
    }
  }
}

void Ax12Emulator::send(const BusServo& from, const EmulatedServo::Reaction& reaction, TimeNs end_ns) noexcept {
  if (noise.happens(noise.faults.missing_answers)) {
    return;
  }
  ++counters_.answers;
  TimeNs at_ns = end_ns + (options_.has_timing ? reaction.thinking_ns : 0);
  if (noise.happens(noise.faults.late_answers)) {
    at_ns += noise.faults.lateness_ns;
  }
  for (const std::uint8_t byte : reaction.answer.bytes()) {
    if (options_.has_timing) {
      const TimeNs into_period_ns = (at_ns + from.interrupt_phase_ns) % kInterruptPeriodNs;
      at_ns += into_period_ns < kInterruptNs ? kInterruptNs - into_period_ns : 0;
    }
    const TimeNs start_ns = at_ns;
    noise.pass(byte, [&](std::uint8_t sent) {
      put_on_wire({at_ns, at_ns + byte_ns_, sent});
      at_ns += byte_ns_;
    });
    at_ns = std::max(at_ns, start_ns + byte_ns_);  // a lost byte took its time
  }
}

void Ax12Emulator::put_on_wire(OutgoingByte byte) noexcept {
  const auto after = std::upper_bound(outgoing_.begin(), outgoing_.end(), byte.start_ns,
                                      [](TimeNs start, const OutgoingByte& other) { return start < other.start_ns; });
  if (after != outgoing_.begin()) {
    OutgoingByte& before = *std::prev(after);
    if (byte.start_ns < before.end_ns && byte.start_ns != before.start_ns) {
      before.value ^= kCollision;  // out of step by part of a byte
      ++counters_.collided_bytes;
      return;
    }
    if (byte_ns_ > 0 && byte.start_ns == before.start_ns && before.value != byte.value) {
      before.value &= byte.value;  // in step: a 0 wins on the shared line
      ++counters_.collided_bytes;
      return;
    }
  }
  outgoing_.insert(after, byte);
}

TimeNs Ax12Emulator::next_ns() const { return outgoing_.empty() ? kNever : outgoing_.front().end_ns; }

std::size_t Ax12Emulator::transmit(TimeNs now_ns, std::span<std::uint8_t> out) {
  std::size_t count = 0;
  while (count < out.size() && !outgoing_.empty() && outgoing_.front().end_ns <= now_ns) {
    out[count++] = outgoing_.front().value;
    outgoing_.pop_front();
  }
  return count;
}

EmulatedServo* Ax12Emulator::find(std::uint8_t id) noexcept {
  for (const BusServo& bus_servo : servos_) {
    if (bus_servo.servo->id() == id) {
      return bus_servo.servo.get();
    }
  }
  return nullptr;
}

Ax12Motion* Ax12Emulator::find_motion(std::uint8_t id) noexcept {
  for (const BusServo& bus_servo : servos_) {
    if (bus_servo.servo->id() == id) {
      return bus_servo.own_motion;
    }
  }
  return nullptr;
}

bool Ax12Emulator::pull_plug(std::uint8_t id, TimeNs now_ns) noexcept {
  for (BusServo& bus_servo : servos_) {
    if (bus_servo.servo->id() == id) {
      bus_servo.is_unplugged = true;
      bus_servo.servo->power_cycle(now_ns);  // torque goes with the power
      return true;
    }
  }
  return false;
}

bool Ax12Emulator::plug_in(std::uint8_t id, TimeNs now_ns) noexcept {
  for (BusServo& bus_servo : servos_) {
    if (bus_servo.servo->id() == id) {
      bus_servo.is_unplugged = false;
      bus_servo.servo->power_cycle(now_ns);
      return true;
    }
  }
  return false;
}

}  // namespace tectum
