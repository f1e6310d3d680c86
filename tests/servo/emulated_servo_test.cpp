#include "drivers/servo/emulated_servo.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "drivers/servo/ax12_motion.h"

using namespace tectum;
using dynamixel::Instruction;
using dynamixel::Packet;

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr TimeNs kMs = 1'000'000;

struct Answer {
  bool came = false;
  std::uint8_t error_bits = 0;
  Bytes data;
  TimeNs thinking_ns = 0;
};

struct Bench {
  explicit Bench(const Ax12MotionParams& params = {}) : motion(params), servo(1, motion, 0) {}

  Answer ask(Instruction instruction, const Bytes& parameters, std::uint8_t id = 1) {
    Packet packet;
    packet.id = id;
    packet.code = static_cast<std::uint8_t>(instruction);
    packet.parameter_count = static_cast<std::uint8_t>(parameters.size());
    std::copy(parameters.begin(), parameters.end(), packet.parameters.begin());
    const EmulatedServo::Reaction reaction = servo.obey(packet, now_ns);
    Answer answer{reaction.is_answered, 0, {}, reaction.thinking_ns};
    if (answer.came) {
      const auto bytes = reaction.answer.bytes();
      answer.error_bits = bytes[dynamixel::kCodeAt];
      answer.data.assign(bytes.begin() + 5, bytes.end() - 1);
    }
    return answer;
  }
  Answer write(std::uint8_t address, Bytes data) {
    data.insert(data.begin(), address);
    return ask(Instruction::Write, data);
  }
  Answer write(const ax12::Register& row, std::uint16_t value) {
    const auto bytes = dynamixel::bytes_of(value);
    return write(row.address, Bytes(bytes.begin(), bytes.begin() + row.size));
  }
  std::uint16_t read(const ax12::Register& row) {
    const Answer answer = ask(Instruction::Read, {row.address, row.size});
    REQUIRE(answer.data.size() == row.size);
    return row.size == 1 ? answer.data[0] : dynamixel::word(answer.data[0], answer.data[1]);
  }
  void wait(TimeNs duration_ns) {
    // In small steps, as a host that polls would see it: alarms are looked for when something is asked.
    for (const TimeNs end_ns = now_ns + duration_ns; now_ns < end_ns; now_ns += kMs) {
      servo.update(now_ns);
    }
  }

  TimeNs now_ns = 0;
  Ax12Motion motion;
  EmulatedServo servo;
};

}  // namespace

TEST_CASE("every register reads as the table says when power comes on") {
  Bench bench;
  for (const ax12::Register& row : ax12::kRegisters) {
    CAPTURE(std::string(row.name));
    CHECK(bench.read(row) == row.initial);
  }
}

TEST_CASE("every writable register takes its least and its greatest value and nothing beyond") {
  for (const ax12::Register& row : ax12::kRegisters) {
    if (row.access == ax12::Access::Read || row.address == ax12::kStatusReturnLevel.address) {
      continue;  // levels below 2 do not answer writes; they have their own test
    }
    CAPTURE(std::string(row.name));
    for (const std::uint16_t value : {row.min, row.max}) {
      Bench bench;
      CHECK(bench.write(row, value).error_bits == 0);
      CHECK(bench.servo.get(row) == value);
    }
    Bench bench;
    const unsigned largest = row.size == 1 ? 0xFF : 0xFFFF;
    if (row.max < largest) {
      CHECK(bench.write(row, static_cast<std::uint16_t>(row.max + 1)).error_bits == dynamixel::kRangeError);
      CHECK(bench.servo.get(row) == row.initial);
    }
    if (row.min > 0) {
      CHECK(bench.write(row, static_cast<std::uint16_t>(row.min - 1)).error_bits == dynamixel::kRangeError);
      CHECK(bench.servo.get(row) == row.initial);
    }
  }
}

TEST_CASE("no read-only register can be written") {
  for (const ax12::Register& row : ax12::kRegisters) {
    if (row.access == ax12::Access::Read) {
      CAPTURE(std::string(row.name));
      Bench bench;
      CHECK(bench.write(row, 1).error_bits == dynamixel::kRangeError);
      CHECK(bench.servo.get(row) == row.initial);
    }
  }
}

TEST_CASE("reserved bytes, half words and the end of the table are refused, and nothing is written") {
  Bench bench;
  CHECK(bench.write(10, {1}).error_bits == dynamixel::kRangeError);
  CHECK(bench.write(45, {1}).error_bits == dynamixel::kRangeError);
  CHECK(bench.write(30, {1}).error_bits == dynamixel::kRangeError);      // low byte alone
  CHECK(bench.write(29, {64, 1}).error_bits == dynamixel::kRangeError);  // slope, and half a goal
  CHECK(bench.servo.get(ax12::kCcwComplianceSlope) == 32);
  CHECK(bench.write(48, {32, 0, 0}).error_bits == dynamixel::kRangeError);  // one beyond the end
  CHECK(bench.ask(Instruction::Read, {49, 2}).error_bits == dynamixel::kRangeError);
  CHECK(bench.ask(Instruction::Read, {0, 50}).data.size() == 50);
}

TEST_CASE("one write may span registers, and one bad value refuses all of it") {
  Bench bench;
  CHECK(bench.write(30, {0x00, 0x01, 0x64, 0x00}).error_bits == 0);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 256);
  CHECK(bench.servo.get(ax12::kMovingSpeed) == 100);
  CHECK(bench.write(30, {0x00, 0x02, 0xFF, 0xFF}).error_bits == dynamixel::kRangeError);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 256);
}

TEST_CASE("a goal outside the angle limits is an angle error and does not move the servo") {
  Bench bench;
  bench.write(ax12::kCwAngleLimit, 300);
  bench.write(ax12::kCcwAngleLimit, 700);
  CHECK(bench.write(ax12::kGoalPosition, 299).error_bits == dynamixel::kAngleError);
  CHECK(bench.write(ax12::kGoalPosition, 701).error_bits == dynamixel::kAngleError);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 512);
  CHECK(bench.write(ax12::kGoalPosition, 700).error_bits == 0);
}

TEST_CASE("a locked EEPROM cannot be written, nor unlocked, until power goes off") {
  Bench bench;
  CHECK(bench.write(ax12::kLock, 1).error_bits == 0);
  CHECK(bench.write(ax12::kReturnDelayTime, 0).error_bits == dynamixel::kRangeError);
  CHECK(bench.write(ax12::kLock, 0).error_bits == dynamixel::kRangeError);
  CHECK(bench.write(ax12::kGoalPosition, 600).error_bits == 0);  // RAM is free
  bench.servo.power_cycle(bench.now_ns);
  CHECK(bench.write(ax12::kReturnDelayTime, 0).error_bits == 0);
}

TEST_CASE("EEPROM outlives the power, RAM does not") {
  Bench bench;
  bench.write(ax12::kTemperatureLimit, 65);
  bench.write(ax12::kMaxTorque, 500);
  bench.write(ax12::kMovingSpeed, 77);
  bench.servo.power_cycle(bench.now_ns);
  CHECK(bench.servo.get(ax12::kTemperatureLimit) == 65);
  CHECK(bench.servo.get(ax12::kMovingSpeed) == 0);
  CHECK(bench.servo.get(ax12::kTorqueLimit) == 500);  // copied from max_torque
}

TEST_CASE("the status return level decides what is answered; a ping always is") {
  for (std::uint16_t level = 0; level <= 2; ++level) {
    CAPTURE(level);
    Bench bench;
    CHECK(bench.write(ax12::kStatusReturnLevel, level).came);  // still answered at the old level
    CHECK(bench.ask(Instruction::Ping, {}).came);
    CHECK(bench.ask(Instruction::Read, {36, 2}).came == (level >= 1));
    CHECK(bench.write(ax12::kGoalPosition, 600).came == (level == 2));
    CHECK(bench.servo.get(ax12::kGoalPosition) == 600);
  }
}

TEST_CASE("nobody answers a broadcast, everybody acts") {
  Bench bench;
  CHECK_FALSE(bench.ask(Instruction::Ping, {}, dynamixel::kBroadcastId).came);
  CHECK_FALSE(bench.ask(Instruction::Read, {36, 2}, dynamixel::kBroadcastId).came);
  CHECK_FALSE(bench.ask(Instruction::Write, {30, 0x58, 0x02}, dynamixel::kBroadcastId).came);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 600);
}

TEST_CASE("a registered write waits for its action; an action without one is an instruction error") {
  Bench bench;
  CHECK(bench.ask(Instruction::RegWrite, {30, 0xF4, 0x01}).error_bits == 0);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 512);
  CHECK(bench.read(ax12::kRegistered) == 1);
  CHECK(bench.ask(Instruction::Action, {}).error_bits == 0);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 500);
  CHECK(bench.read(ax12::kRegistered) == 0);
  CHECK(bench.ask(Instruction::Action, {}).error_bits == dynamixel::kInstructionError);
}

TEST_CASE("a sync write gives each servo its own share") {
  Bench bench;
  const Bytes shares = {30, 2, 7, 0x10, 0x00, 1, 0x20, 0x01, 9, 0x30, 0x00};
  CHECK_FALSE(bench.ask(Instruction::SyncWrite, shares, dynamixel::kBroadcastId).came);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 0x120);
}

TEST_CASE("an AX-12A knows neither bulk read nor an unknown instruction") {
  Bench bench;
  CHECK(bench.ask(Instruction::BulkRead, {0, 2, 1, 30}).error_bits == dynamixel::kInstructionError);
  CHECK(bench.ask(static_cast<Instruction>(0x55), {}).error_bits == dynamixel::kInstructionError);
}

TEST_CASE("a factory reset brings back everything, the ID included") {
  Bench bench;
  bench.write(ax12::kId, 9);
  CHECK(bench.servo.id() == 9);
  bench.write(ax12::kCwAngleLimit, 300);
  CHECK(bench.ask(Instruction::FactoryReset, {}, 9).came);
  CHECK(bench.servo.id() == 1);
  CHECK(bench.servo.get(ax12::kCwAngleLimit) == 0);
}

TEST_CASE("the answer waits for the return delay, two microseconds a unit") {
  Bench bench;
  CHECK(bench.ask(Instruction::Ping, {}).thinking_ns == 518'000);
  bench.write(ax12::kReturnDelayTime, 0);
  CHECK(bench.ask(Instruction::Ping, {}).thinking_ns == 18'000);
  CHECK(bench.ask(Instruction::Read, {36, 2}).thinking_ns == 22'000);
  CHECK(bench.write(ax12::kGoalPosition, 512).thinking_ns == 24'000 + 3 * 6'000);
}

TEST_CASE("writing the EEPROM makes the servo deaf for six milliseconds a byte") {
  Bench bench;
  bench.write(ax12::kCwAngleLimit, 100);
  CHECK(bench.servo.is_deaf(11 * kMs));
  CHECK_FALSE(bench.servo.is_deaf(12 * kMs));
}

TEST_CASE("without torque the goal follows the shaft, and writing a goal switches torque on") {
  Bench bench;
  bench.motion.turn_to(100);
  bench.servo.update(bench.now_ns);
  CHECK(bench.servo.get(ax12::kGoalPosition) == 341);
  bench.write(ax12::kGoalPosition, 400);
  CHECK(bench.servo.get(ax12::kTorqueEnable) == 1);
}

TEST_CASE("the shaft moves to the goal, no faster than the moving speed") {
  Bench bench;
  bench.write(30, {0xBC, 0x02, 0x64, 0x00});  // 700 units at 100, which is 66.6 deg/s
  bench.wait(100 * kMs);
  const std::uint16_t early = bench.read(ax12::kPresentPosition);
  bench.wait(300 * kMs);
  const double speed_deg_s = (bench.read(ax12::kPresentPosition) - early) * ax12::kUnitDeg / 0.3;
  CHECK(speed_deg_s == doctest::Approx(66.6).epsilon(0.03));
  CHECK(bench.read(ax12::kPresentSpeed) == doctest::Approx(100).epsilon(0.02));
  CHECK(bench.read(ax12::kMoving) == 1);
  bench.wait(1500 * kMs);
  CHECK(bench.read(ax12::kPresentPosition) == doctest::Approx(700).epsilon(0.005));
  CHECK(bench.read(ax12::kMoving) == 0);
}

TEST_CASE("nothing moves before the dead time is over") {
  Bench bench({.dead_time_s = 0.030});
  bench.write(ax12::kGoalPosition, 700);
  bench.wait(29 * kMs);
  CHECK(bench.read(ax12::kPresentPosition) == 512);
  bench.wait(20 * kMs);
  CHECK(bench.read(ax12::kPresentPosition) > 512);
}

TEST_CASE("with both angle limits zero the servo is a wheel that turns at its speed's share of torque") {
  Bench bench;
  bench.write(ax12::kCcwAngleLimit, 0);
  bench.write(ax12::kTorqueEnable, 1);
  CHECK(bench.write(ax12::kMovingSpeed, 1024 + 512).error_bits == 0);  // clockwise; too much for a joint
  bench.wait(500 * kMs);
  const double speed = bench.read(ax12::kPresentSpeed);
  CHECK(speed > 1024);
  CHECK((speed - 1024) * ax12::kSpeedUnitDegS == doctest::Approx(354 * 11.1 / 12 * 512 / 1023).epsilon(0.02));
}

TEST_CASE("a stall overloads: torque limit 0, and the bit stays until the limit is written") {
  Bench bench;
  bench.motion.block(true);
  bench.write(ax12::kGoalPosition, 700);
  bench.wait(400 * kMs);
  CHECK(bench.ask(Instruction::Ping, {}).error_bits == 0);
  bench.wait(400 * kMs);
  CHECK(bench.ask(Instruction::Ping, {}).error_bits == dynamixel::kOverloadError);
  CHECK(bench.read(ax12::kTorqueLimit) == 0);
  bench.motion.block(false);
  bench.wait(1000 * kMs);
  CHECK(bench.read(ax12::kPresentPosition) == 512);  // limp
  bench.write(ax12::kTorqueLimit, 1023);
  CHECK(bench.ask(Instruction::Ping, {}).error_bits == 0);
  bench.wait(1000 * kMs);
  CHECK(bench.read(ax12::kPresentPosition) > 690);
}

TEST_CASE("heat shuts the servo down again until it has cooled") {
  Bench bench;
  bench.write(ax12::kTorqueEnable, 1);
  bench.servo.set_temperature_c(71);
  CHECK(bench.ask(Instruction::Ping, {}).error_bits == dynamixel::kHeatError);
  CHECK(bench.read(ax12::kTorqueLimit) == 0);
  bench.write(ax12::kTorqueLimit, 1023);
  CHECK(bench.read(ax12::kTorqueLimit) == 0);
  bench.servo.set_temperature_c(60);
  bench.write(ax12::kTorqueLimit, 1023);
  CHECK(bench.read(ax12::kTorqueLimit) == 1023);
  CHECK(bench.ask(Instruction::Ping, {}).error_bits == 0);
}

TEST_CASE("a supply outside its limits is reported, and shuts down only where register 18 says so") {
  Bench bench;
  bench.servo.set_supply_v(5.5);
  CHECK(bench.ask(Instruction::Ping, {}).error_bits == dynamixel::kVoltageError);
  CHECK(bench.read(ax12::kPresentVoltage) == 55);
  CHECK(bench.read(ax12::kTorqueLimit) == 1023);
  bench.write(ax12::kShutdown, dynamixel::kVoltageError);
  CHECK(bench.read(ax12::kTorqueLimit) == 0);
}
