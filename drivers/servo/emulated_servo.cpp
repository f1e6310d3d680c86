#include "drivers/servo/emulated_servo.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tectum {
namespace {

using namespace dynamixel;

// Xevel, "USB2AX: Dynamixel protocol notes": with a return delay of 0 an answer starts after these.
constexpr TimeNs kPingNs = 18'000;
constexpr TimeNs kReadNs = 22'000;
constexpr TimeNs kWriteNs = 24'000;
constexpr TimeNs kWriteByteNs = 6'000;
constexpr TimeNs kEepromByteNs = 6'000'000;

constexpr TimeNs kOverloadAfterNs = 500'000'000;
constexpr double kStallSpeedDegS = 2;

bool is_eeprom(std::uint8_t address) { return address < ax12::kFirstRamAddress; }

bool overlaps(const ax12::Register& row, std::uint8_t address, std::size_t size) {
  return row.address < address + size && address < row.address + row.size;
}

// The manual's "data representative value": 2, 4, 8, .. 128.
double acting_slope_units(std::uint16_t slope) {
  return std::clamp(static_cast<double>(std::bit_floor(static_cast<unsigned>(slope))), 2.0, 128.0);
}

std::uint16_t with_direction(double magnitude, double top, bool is_clockwise) {
  const auto value = static_cast<std::uint16_t>(std::lround(std::clamp(magnitude, 0.0, top)));
  return static_cast<std::uint16_t>(value | (is_clockwise ? ax12::kDirectionBit : 0));
}

double with_sign(std::uint16_t value) {
  const double magnitude = value & (ax12::kDirectionBit - 1);
  return (value & ax12::kDirectionBit) != 0 ? -magnitude : magnitude;
}

}  // namespace

EmulatedServo::EmulatedServo(std::uint8_t id, ServoMotion& motion, TimeNs now_ns) noexcept : motion_(motion) {
  for (const ax12::Register& row : ax12::kRegisters) {
    put(row, row.initial);
  }
  put(ax12::kId, id);
  load_ram();
  update(now_ns);
  drive_motor(now_ns);
}

std::uint16_t EmulatedServo::get(const ax12::Register& row) const noexcept {
  return row.size == 1 ? table_[row.address] : word(table_[row.address], table_[row.address + 1U]);
}

void EmulatedServo::put(const ax12::Register& row, std::uint16_t value) noexcept {
  const auto bytes = bytes_of(value);
  std::copy_n(bytes.begin(), row.size, table_.begin() + row.address);
}

void EmulatedServo::set(const ax12::Register& row, std::uint16_t value, TimeNs now_ns) noexcept {
  put(row, value);
  drive_motor(now_ns);
}

void EmulatedServo::load_ram() noexcept {
  for (const ax12::Register& row : ax12::kRegisters) {
    if (!is_eeprom(row.address)) {
      put(row, row.initial);
    }
  }
  put(ax12::kTorqueLimit, get(ax12::kMaxTorque));
  registered_size_ = 0;
  alarm_bits_ = 0;
  is_stalled_ = false;
}

void EmulatedServo::power_cycle(TimeNs now_ns) noexcept {
  load_ram();
  busy_until_ns_ = 0;
  update(now_ns);
  drive_motor(now_ns);
}

void EmulatedServo::reset_to_factory(TimeNs now_ns) noexcept {
  for (const ax12::Register& row : ax12::kRegisters) {
    if (is_eeprom(row.address)) {
      put(row, row.initial);
    }
  }
  power_cycle(now_ns);
}

bool EmulatedServo::is_wheel() const noexcept {
  return get(ax12::kCwAngleLimit) == 0 && get(ax12::kCcwAngleLimit) == 0;
}

void EmulatedServo::drive_motor(TimeNs now_ns) noexcept {
  ServoDrive drive;
  drive.goal_deg = get(ax12::kGoalPosition) * ax12::kUnitDeg;
  drive.speed_deg_s = (get(ax12::kMovingSpeed) & ax12::kHighestPosition) * ax12::kSpeedUnitDegS;
  drive.torque_share = get(ax12::kTorqueEnable) == 0 ? 0 : get(ax12::kTorqueLimit) / 1023.0;
  drive.cw_margin_deg = get(ax12::kCwComplianceMargin) * ax12::kUnitDeg;
  drive.ccw_margin_deg = get(ax12::kCcwComplianceMargin) * ax12::kUnitDeg;
  drive.cw_slope_deg = acting_slope_units(get(ax12::kCwComplianceSlope)) * ax12::kUnitDeg;
  drive.ccw_slope_deg = acting_slope_units(get(ax12::kCcwComplianceSlope)) * ax12::kUnitDeg;
  drive.punch_share = get(ax12::kPunch) / 1023.0;
  drive.is_wheel = is_wheel();
  drive.wheel_share = with_sign(get(ax12::kMovingSpeed)) / 1023.0;
  drive.supply_v = supply_v_;
  motion_.drive(now_ns, drive);
}

void EmulatedServo::update(TimeNs now_ns) noexcept {
  const ShaftState shaft = motion_.shaft(now_ns);
  const double units = std::clamp(shaft.position_deg / ax12::kUnitDeg, 0.0, double{ax12::kHighestPosition});
  put(ax12::kPresentPosition, static_cast<std::uint16_t>(std::lround(units)));
  put(ax12::kPresentSpeed,
      with_direction(std::abs(shaft.speed_deg_s) / ax12::kSpeedUnitDegS, 1023, shaft.speed_deg_s < 0));
  put(ax12::kPresentLoad, with_direction(std::abs(shaft.load_share) * 1000, 1023, shaft.load_share < 0));
  put(ax12::kPresentVoltage, static_cast<std::uint16_t>(std::clamp(std::lround(supply_v_ * 10), 0L, 255L)));
  put(ax12::kPresentTemperature, static_cast<std::uint16_t>(std::clamp(temperature_c_, 0, 255)));
  if (get(ax12::kTorqueEnable) == 0) {
    put(ax12::kGoalPosition, get(ax12::kPresentPosition));
  }
  const int away = std::abs(get(ax12::kGoalPosition) - get(ax12::kPresentPosition));
  put(ax12::kMoving, away > get(ax12::kCwComplianceMargin) + 1 && std::abs(shaft.speed_deg_s) > kStallSpeedDegS);
  watch_for_alarms(shaft, now_ns);
}

void EmulatedServo::watch_for_alarms(const ShaftState& shaft, TimeNs now_ns) noexcept {
  const double torque_share = get(ax12::kTorqueEnable) == 0 ? 0 : get(ax12::kTorqueLimit) / 1023.0;
  const bool stalls = torque_share > 0 && std::abs(shaft.load_share) >= 0.99 * torque_share &&
                      std::abs(shaft.speed_deg_s) < kStallSpeedDegS;
  if (stalls && !is_stalled_) {
    stalled_since_ns_ = now_ns;
  }
  is_stalled_ = stalls;

  const std::uint16_t voltage = get(ax12::kPresentVoltage);
  std::uint8_t bits = alarm_bits_ & kOverloadError;
  if (stalls && now_ns - stalled_since_ns_ >= kOverloadAfterNs) {
    bits |= kOverloadError;
  }
  if (voltage < get(ax12::kMinVoltageLimit) || voltage > get(ax12::kMaxVoltageLimit)) {
    bits |= kVoltageError;
  }
  if (get(ax12::kPresentTemperature) > get(ax12::kTemperatureLimit)) {
    bits |= kHeatError;
  }
  alarm_bits_ = bits;
  if ((bits & get(ax12::kShutdown)) != 0 && get(ax12::kTorqueLimit) != 0) {
    put(ax12::kTorqueLimit, 0);
    drive_motor(now_ns);
  }
}

std::uint8_t EmulatedServo::check_write(std::uint8_t address, Bytes data) const noexcept {
  if (data.empty() || address + data.size() > ax12::kTableSize) {
    return kRangeError;
  }
  std::size_t covered = 0;
  for (const ax12::Register& row : ax12::kRegisters) {
    if (!overlaps(row, address, data.size())) {
      continue;
    }
    const bool is_whole = row.address >= address && row.address + row.size <= address + data.size();
    if (!is_whole || row.access == ax12::Access::Read) {
      return kRangeError;
    }
    if (is_eeprom(row.address) && get(ax12::kLock) != 0) {
      return kRangeError;
    }
    const std::size_t at = row.address - address;
    const std::uint16_t value = row.size == 1 ? data[at] : word(data[at], data[at + 1]);
    const std::uint16_t max = row.address == ax12::kMovingSpeed.address && is_wheel() ? 2047 : row.max;
    if (value < row.min || value > max || (row.address == ax12::kLock.address && value < get(ax12::kLock))) {
      return kRangeError;
    }
    if (row.address == ax12::kGoalPosition.address && !is_wheel() &&
        (value < get(ax12::kCwAngleLimit) || value > get(ax12::kCcwAngleLimit))) {
      return kAngleError;
    }
    covered += row.size;
  }
  return covered == data.size() ? 0 : kRangeError;  // the rest are reserved bytes
}

void EmulatedServo::write(std::uint8_t address, Bytes data, TimeNs now_ns) noexcept {
  std::copy(data.begin(), data.end(), table_.begin() + address);
  if (overlaps(ax12::kGoalPosition, address, data.size())) {
    put(ax12::kTorqueEnable, 1);
  }
  if (overlaps(ax12::kTorqueLimit, address, data.size()) && get(ax12::kTorqueLimit) != 0) {
    alarm_bits_ &= static_cast<std::uint8_t>(~kOverloadError);
    is_stalled_ = false;
  }
  if (is_eeprom(address)) {
    busy_until_ns_ = now_ns + kEepromByteNs * static_cast<TimeNs>(data.size());
  }
  drive_motor(now_ns);
}

std::uint8_t EmulatedServo::write_checked(std::uint8_t address, Bytes data, TimeNs now_ns) noexcept {
  const std::uint8_t errors = check_write(address, data);
  if (errors == 0) {
    write(address, data, now_ns);
  }
  return errors;
}

std::uint8_t EmulatedServo::read(Bytes parameters, std::array<std::uint8_t, ax12::kTableSize>& out,
                                 std::size_t& count) const noexcept {
  const std::size_t address = parameters[0];
  const std::size_t wanted = parameters[1];
  if (wanted == 0 || address + wanted > table_.size()) {
    count = 0;
    return kRangeError;
  }
  std::copy_n(table_.begin() + static_cast<std::ptrdiff_t>(address), wanted, out.begin());
  count = wanted;
  return 0;
}

std::uint8_t EmulatedServo::remember(Bytes parameters) noexcept {
  const std::uint8_t errors = check_write(parameters[0], parameters.subspan(1));
  if (errors == 0) {
    std::copy(parameters.begin(), parameters.end(), registered_.begin());
    registered_size_ = parameters.size();
    put(ax12::kRegistered, 1);
  }
  return errors;
}

std::uint8_t EmulatedServo::act(TimeNs now_ns) noexcept {
  if (registered_size_ == 0) {
    return kInstructionError;
  }
  const Bytes parameters = std::span(registered_).first(registered_size_);
  registered_size_ = 0;
  put(ax12::kRegistered, 0);
  return write_checked(parameters[0], parameters.subspan(1), now_ns);
}

std::uint8_t EmulatedServo::take_share(Bytes parameters, TimeNs now_ns) noexcept {
  const std::size_t size_each = parameters[1];
  for (std::size_t at = 2; at + 1 + size_each <= parameters.size(); at += 1 + size_each) {
    if (parameters[at] == id()) {
      return write_checked(parameters[0], parameters.subspan(at + 1, size_each), now_ns);
    }
  }
  return 0;
}

EmulatedServo::Reaction EmulatedServo::report_bad_checksum(TimeNs now_ns) noexcept {
  update(now_ns);
  if (get(ax12::kStatusReturnLevel) < 2) {
    return {};
  }
  return {true, encode_status(id(), static_cast<std::uint8_t>(alarm_bits_ | kChecksumError), {}),
          kPingNs + static_cast<TimeNs>(get(ax12::kReturnDelayTime) * ax12::kReturnDelayUnitNs)};
}

std::uint8_t EmulatedServo::execute(const Packet& instruction, TimeNs now_ns) noexcept {
  const Bytes parameters = instruction.payload();
  if (!has_fitting_length(instruction)) {
    return kInstructionError;
  }
  switch (static_cast<Instruction>(instruction.code)) {
    case Instruction::Ping:
      return 0;
    case Instruction::Write:
      return write_checked(parameters[0], parameters.subspan(1), now_ns);
    case Instruction::RegWrite:
      return remember(parameters);
    case Instruction::Action:
      return act(now_ns);
    case Instruction::SyncWrite:
      return take_share(parameters, now_ns);
    case Instruction::FactoryReset:
      reset_to_factory(now_ns);
      busy_until_ns_ = now_ns + kEepromByteNs * ax12::kFirstRamAddress;
      return 0;
    default:  // BulkRead is for the MX series, SyncRead for the ArbotiX
      return kInstructionError;
  }
}

EmulatedServo::Reaction EmulatedServo::obey(const Packet& instruction, TimeNs now_ns) noexcept {
  update(now_ns);
  const bool is_for_all = instruction.id == kBroadcastId;
  // An answer to a new ID, level or delay still goes by the old ones.
  const std::uint8_t own_id = id();
  const std::uint16_t level = get(ax12::kStatusReturnLevel);
  const auto delay_ns = static_cast<TimeNs>(get(ax12::kReturnDelayTime) * ax12::kReturnDelayUnitNs);

  std::array<std::uint8_t, ax12::kTableSize> data{};
  std::size_t count = 0;
  std::uint8_t errors = 0;
  TimeNs thinking_ns = kPingNs;
  std::uint16_t answered_from_level = 2;
  if (instruction.code == static_cast<std::uint8_t>(Instruction::Read) && has_fitting_length(instruction)) {
    errors = read(instruction.payload(), data, count);
    thinking_ns = kReadNs;
    answered_from_level = 1;
  } else {
    errors = execute(instruction, now_ns);
    if (instruction.code == static_cast<std::uint8_t>(Instruction::Ping)) {
      answered_from_level = 0;
    } else {
      thinking_ns = kWriteNs + kWriteByteNs * instruction.parameter_count;
    }
  }
  if ((errors & get(ax12::kShutdown)) != 0) {
    put(ax12::kTorqueLimit, 0);
    drive_motor(now_ns);
  }
  if (is_for_all || level < answered_from_level) {
    return {};
  }
  return {true, encode_status(own_id, static_cast<std::uint8_t>(alarm_bits_ | errors), std::span(data).first(count)),
          thinking_ns + delay_ns};
}

}  // namespace tectum
