#include "drivers/servo/packet_exchange.h"

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

using namespace dynamixel;

constexpr int kMuteSigns = 3;     // before it is no accident
constexpr int kMostReadings = 4;  // until two in succession agree
constexpr double kTopUnitsPerNs = ax12::kNoLoadSpeedDegS / ax12::kUnitDeg * 1e-9;
constexpr int kPlausibleSlackUnits = 3;  // a shaft swings a little beyond what its speed alone allows
constexpr int kWarmC = 5;                // below the limit is worth a word
constexpr int kReleaseRepeats = 3;

// [0, 19): model_number to shutdown.
constexpr std::size_t kSetupSize = 19;
// [24, 50): the RAM. 26 bytes, the most that an ArbotiX passes.
constexpr std::uint8_t kRamAt = ax12::kFirstRamAddress;
constexpr std::size_t kRamSize = ax12::kTableSize - ax12::kFirstRamAddress;
constexpr std::size_t kComplianceSize = 4;  // from cw_compliance_margin on
constexpr int kVoltageSwing = 5;            // 0.5 V between two readings of a motor's supply

std::uint16_t value_in(std::span<const std::uint8_t> bytes, std::uint8_t first_address, const ax12::Register& row) {
  const std::size_t at = row.address - std::size_t{first_address};
  return row.size == 1 ? bytes[at] : word(bytes[at], bytes[at + 1]);
}

// Whether two readings agree in all that does not change by itself.
bool is_same_setting(std::uint8_t address, std::span<const std::uint8_t> one, std::span<const std::uint8_t> other) {
  for (std::size_t i = 0; i < one.size(); ++i) {
    const std::size_t at = address + i;
    const bool is_moving_part = at >= ax12::kPresentPosition.address && at < ax12::kPresentVoltage.address;
    if (is_moving_part || at == ax12::kMoving.address) {
      continue;
    }
    // Without torque the goal follows the shaft.
    const int swing = at == ax12::kPresentVoltage.address       ? kVoltageSwing
                      : at == ax12::kPresentTemperature.address ? 1
                      : at == ax12::kGoalPosition.address       ? 1
                                                                : 0;
    if (std::abs(one[i] - other[i]) > swing) {
      return false;
    }
  }
  return true;
}

std::uint16_t speed_units(const ServoJoint& joint) {
  if (joint.max_speed_deg_s <= 0) {
    return 0;
  }
  const double units = std::round(joint.max_speed_deg_s / ax12::kSpeedUnitDegS);
  return static_cast<std::uint16_t>(std::clamp(units, 1.0, 1023.0));  // 0 would be as fast as it can
}

}  // namespace

PacketExchange::PacketExchange(ByteLink& link, const ServoMap& map, const PacketExchangeOptions& options,
                               HeadReport& report, ServoEventLog& events)
    : map_(map), options_(options), report_(report), events_(events), bus_(link, options.bus), link_(link) {}

std::string PacketExchange::name(std::size_t joint) const {
  return "servo " + std::to_string(id(joint)) + " (" + kJointNames[joint] + ")";
}

void PacketExchange::tell(std::size_t joint, const std::string& what) {
  events_.add(link_.now_ns(), name(joint) + " " + what);
}

void PacketExchange::note(const BusAnswer& answer) noexcept {
  is_link_gone_ = is_link_gone_ || answer.status == BusStatus::LinkGone;
}

// --- getting ready -------------------------------------------------------------------------------------------------

ExchangeStatus PacketExchange::begin() {
  noisy_until_ns_ = link_.now_ns() + options_.noise_memory_ns;
  for (std::size_t joint = 0; joint < kJointCount && !is_link_gone_; ++joint) {
    health(joint) = ServoHealth::Unknown;
    joints_[joint] = {};
    for (int tries = 0; is_present(joint) && health(joint) == ServoHealth::Unknown && tries < kMuteSigns; ++tries) {
      get_ready(joint);
    }
    if (is_present(joint) && health(joint) == ServoHealth::Unknown && joints_[joint].mute_signs < kMuteSigns) {
      tell(joint, "does not answer");
    }
  }
  report_.is_connected = !is_link_gone_;
  report_.is_torque_on = false;
  report_.wire = bus_.statistics();
  return is_link_gone_ ? ExchangeStatus::LinkGone : ExchangeStatus::RoundOver;
}

void PacketExchange::get_ready(std::size_t joint) {
  JointState& state = joints_[joint];
  state.asked_ns = link_.now_ns();
  const BusAnswer present = bus_.ping(id(joint));
  note(present);
  if (!present.is_ok()) {
    return;
  }
  std::array<std::uint8_t, kSetupSize> setup;
  const BusAnswer answer = read_surely(joint, 0, setup);
  if (!answer.is_ok()) {
    if (answer.status == BusStatus::NoAnswer && ++state.mute_signs == kMuteSigns) {
      tell(joint, "answers pings only: write 2 to its status_return_level");
    }
    return;
  }
  if (options_.locks_eeprom) {
    note(bus_.write(id(joint), ax12::kLock, 1));
  }
  std::array<std::uint8_t, kRamSize> ram;
  if (!read_surely(joint, kRamAt, ram).is_ok()) {
    return;
  }
  state.answered_ns = link_.now_ns();
  state.needs_torque = true;
  state.has_goal = false;
  state.has_reading = false;
  std::copy_n(ram.begin() + (ax12::kCwComplianceMargin.address - kRamAt), kComplianceSize, state.compliance.begin());
  state.punch = value_in(ram, kRamAt, ax12::kPunch);
  health(joint) = ServoHealth::Working;
  check_setup(joint, setup);
  // A servo that shut down before we came has a torque limit of 0: it is let rest like any other.
  if (health(joint) == ServoHealth::Working && value_in(ram, kRamAt, ax12::kTorqueLimit) == 0) {
    check_shutdown(joint);
  }
}

BusAnswer PacketExchange::read_surely(std::size_t joint, std::uint8_t address, std::span<std::uint8_t> out) {
  std::array<std::uint8_t, kRamSize> before;
  BusAnswer answer;
  bool has_before = false;
  for (int readings = 0; readings < kMostReadings; ++readings) {
    answer = bus_.read(id(joint), address, out);
    note(answer);
    if (!answer.is_ok()) {
      return answer;
    }
    if (has_before && is_same_setting(address, out, before)) {
      return answer;
    }
    has_before = true;
    std::copy(out.begin(), out.end(), before.begin());
  }
  return {BusStatus::Damaged, answer.error_bits};
}

void PacketExchange::check_setup(std::size_t joint, std::span<const std::uint8_t> setup) {
  const auto value = [&](const ax12::Register& row) { return value_in(setup, 0, row); };
  const std::uint16_t model = word(setup[0], setup[1]);
  if (model != ax12::kModelNumber) {
    tell(joint, "is model " + std::to_string(model) + ", not an AX-12A");
  }
  const auto delay_ns = static_cast<TimeNs>(value(ax12::kReturnDelayTime) * ax12::kReturnDelayUnitNs);
  bus_.set_return_delay(id(joint), delay_ns);
  bus_.set_return_level(id(joint), static_cast<std::uint8_t>(value(ax12::kStatusReturnLevel)));
  joints_[joint].temperature_limit_c = value(ax12::kTemperatureLimit);
  if (delay_ns > 0) {
    tell(joint,
         "waits " + std::to_string(delay_ns / 1000) + " us before each answer: write 0 to its return_delay_time");
  }
  const std::uint16_t lowest = value(ax12::kCwAngleLimit);
  const std::uint16_t highest = value(ax12::kCcwAngleLimit);
  if (lowest == 0 && highest == 0) {
    tell(joint, "is set up as a wheel: write its cw_angle_limit and ccw_angle_limit");
    health(joint) = ServoHealth::GivenUp;
    return;
  }
  ServoJoint& mapped = map_.joints[joint];
  if (lowest > mapped.min_units || highest < mapped.max_units) {
    // A goal beyond its own limits would be refused, and the joint would stop short without a word.
    mapped.min_units = std::max(mapped.min_units, lowest);
    mapped.max_units = std::min(mapped.max_units, highest);
    if (mapped.min_units > mapped.max_units) {
      tell(joint, "has angle limits that leave nothing of the joint's range");
      health(joint) = ServoHealth::GivenUp;
    }
  }
}

// --- commands ------------------------------------------------------------------------------------------------------

ExchangeStatus PacketExchange::send(const ServoCommand& command) {
  ++report_.commands;
  if (!command.torque_on) {
    switch_torque_off();
  } else {
    report_.is_torque_on = true;
    for (std::size_t joint = 0; joint < kJointCount; ++joint) {
      const bool is_meant = (command.joint_mask >> joint & 1U) != 0 && is_present(joint);
      if (!is_meant || health(joint) != ServoHealth::Working) {
        continue;
      }
      if (const auto units = units_of(map_.joints[joint], command.goal_deg[joint])) {
        joints_[joint].has_goal = true;
        joints_[joint].goal_units = *units;
      }
    }
    write_goals();
    for (std::size_t joint = 0; joint < kJointCount && !is_link_gone_; ++joint) {
      if (joints_[joint].needs_torque && joints_[joint].has_goal) {
        switch_torque_on(joint);
      }
    }
  }
  report_.wire = bus_.statistics();
  return is_link_gone_ ? ExchangeStatus::LinkGone : ExchangeStatus::Busy;
}

void PacketExchange::write_goals() {
  std::array<std::uint8_t, kJointCount> ids;
  std::array<std::uint8_t, 4 * kJointCount> data;  // goal_position, moving_speed
  std::size_t count = 0;
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    if (joints_[joint].has_goal && health(joint) == ServoHealth::Working) {
      const auto goal = bytes_of(joints_[joint].goal_units);
      const auto speed = bytes_of(speed_units(map_.joints[joint]));
      ids[count] = id(joint);
      std::copy(goal.begin(), goal.end(), data.begin() + static_cast<std::ptrdiff_t>(4 * count));
      std::copy(speed.begin(), speed.end(), data.begin() + static_cast<std::ptrdiff_t>(4 * count + 2));
      ++count;
    }
  }
  if (count > 0) {
    note(
        bus_.sync_write(ax12::kGoalPosition.address, 4, std::span(ids).first(count), std::span(data).first(4 * count)));
  }
}

void PacketExchange::switch_torque_on(std::size_t joint) {
  const BusAnswer answer = bus_.write(id(joint), ax12::kTorqueEnable, 1);
  note(answer);
  if (answer.is_ok()) {
    joints_[joint].needs_torque = false;  // otherwise the next command tries again
  }
}

void PacketExchange::switch_torque_off() {
  report_.is_torque_on = false;
  const std::uint8_t off = 0;
  // To all at once and more than once, because nobody answers; then one by one, because that is answered.
  for (int repeat = 0; repeat < kReleaseRepeats && !is_link_gone_; ++repeat) {
    note(bus_.write(kBroadcastId, ax12::kTorqueEnable.address, std::span(&off, 1)));
  }
  for (std::size_t joint = 0; joint < kJointCount && !is_link_gone_; ++joint) {
    joints_[joint].has_goal = false;
    joints_[joint].needs_torque = true;
    if (is_present(joint) && health(joint) != ServoHealth::Unknown && health(joint) != ServoHealth::Lost) {
      note(bus_.write(id(joint), ax12::kTorqueEnable, 0));
    }
  }
}

void PacketExchange::release() {
  if (!is_link_gone_) {
    switch_torque_off();
    report_.wire = bus_.statistics();
  }
}

// --- measurements --------------------------------------------------------------------------------------------------

ExchangeStatus PacketExchange::poll() {
  if (next_joint_ == 0 && report_.is_torque_on) {
    write_goals();
  }
  if (!is_link_gone_ && is_present(next_joint_)) {
    ask(next_joint_);
  }
  report_.wire = bus_.statistics();
  if (is_link_gone_) {
    report_.is_connected = false;
    return ExchangeStatus::LinkGone;
  }
  next_joint_ = (next_joint_ + 1) % kJointCount;
  if (next_joint_ != 0) {
    return ExchangeStatus::Busy;
  }
  thorough_joint_ = (thorough_joint_ + 1) % kJointCount;
  ++report_.rounds;
  return ExchangeStatus::RoundOver;
}

void PacketExchange::ask(std::size_t joint) {
  JointState& state = joints_[joint];
  const TimeNs now_ns = link_.now_ns();
  const ServoHealth before = health(joint);
  if (before == ServoHealth::Unknown || before == ServoHealth::Lost) {
    if (now_ns - state.asked_ns >= options_.ask_lost_every_ns) {
      come_back(joint);
    }
    return;
  }
  state.asked_ns = now_ns;
  Reading reading;
  const bool is_read = joint == thorough_joint_ ? read_everything(joint, reading) : read_position(joint, reading);
  if (is_link_gone_) {
    return;
  }
  if (!is_read) {
    note_silence(joint);
    return;
  }
  take_reading(joint, reading);
  if (health(joint) == ServoHealth::ShutDown && link_.now_ns() >= state.revive_at_ns) {
    revive(joint);
  }
}

bool PacketExchange::read_position(std::size_t joint, Reading& reading) {
  const BusAnswer answer = bus_.read(id(joint), ax12::kPresentPosition, reading.units);
  reading.at_ns = link_.now_ns();
  note(answer);
  if (!answer.is_ok()) {
    return false;
  }
  note_answer(joint, answer);
  return true;
}

bool PacketExchange::read_everything(std::size_t joint, Reading& reading) {
  std::array<std::uint8_t, kRamSize> ram;
  const BusAnswer answer = is_wire_noisy() ? read_surely(joint, kRamAt, ram) : bus_.read(id(joint), kRamAt, ram);
  reading.at_ns = link_.now_ns();
  note(answer);
  if (!answer.is_ok()) {
    return false;
  }
  reading.units = value_in(ram, kRamAt, ax12::kPresentPosition);
  take_ram(joint, ram);
  if (is_link_gone_ || health(joint) == ServoHealth::Unknown) {
    return false;
  }
  note_answer(joint, answer);
  return !is_link_gone_;
}

void PacketExchange::take_ram(std::size_t joint, std::span<const std::uint8_t> ram) {
  const auto value = [&](const ax12::Register& row) { return value_in(ram, kRamAt, row); };
  JointState& state = joints_[joint];
  JointReport& told = report_.joints[joint];
  const std::uint16_t load = value(ax12::kPresentLoad);
  const double load_share = (load & (ax12::kDirectionBit - 1)) / 1000.0;
  told.load_share = (load & ax12::kDirectionBit) != 0 ? -load_share : load_share;
  told.supply_v = value(ax12::kPresentVoltage) / 10.0;
  told.temperature_c = value(ax12::kPresentTemperature);
  const bool is_hot = told.temperature_c >= state.temperature_limit_c - kWarmC;
  if (is_hot && !state.is_told_hot) {
    tell(joint, "is at " + std::to_string(told.temperature_c) + " C and shuts down above " +
                    std::to_string(state.temperature_limit_c) + " C");
  }
  state.is_told_hot = is_hot;

  // A servo that lost its power for a moment is back before it was missed, but limp and unlocked.
  const bool should_hold = report_.is_torque_on && state.has_goal && !state.needs_torque;
  if ((should_hold && value(ax12::kTorqueEnable) == 0) || (options_.locks_eeprom && value(ax12::kLock) == 0)) {
    tell(joint, "was reset, as by a power cut; it is got ready again");
    health(joint) = ServoHealth::Unknown;
    get_ready(joint);
  } else if (health(joint) == ServoHealth::Working) {
    put_settings_back(joint, ram);
  }
}

void PacketExchange::put_settings_back(std::size_t joint, std::span<const std::uint8_t> ram) {
  const JointState& state = joints_[joint];
  const auto compliance = ram.subspan(ax12::kCwComplianceMargin.address - std::size_t{kRamAt}, kComplianceSize);
  if (!std::equal(compliance.begin(), compliance.end(), state.compliance.begin())) {
    note(bus_.write(id(joint), ax12::kCwComplianceMargin.address, state.compliance));
  }
  if (value_in(ram, kRamAt, ax12::kPunch) != state.punch) {
    note(bus_.write(id(joint), ax12::kPunch, state.punch));
  }
  const std::uint16_t limit = value_in(ram, kRamAt, ax12::kTorqueLimit);
  if (limit == 0) {
    check_shutdown(joint);  // limp, whether an alarm says so or noise wrote it
  } else if (limit != map_.joints[joint].torque_limit) {
    note(bus_.write(id(joint), ax12::kTorqueLimit, map_.joints[joint].torque_limit));
  }
}

bool PacketExchange::is_wire_noisy() noexcept {
  const BusStatistics& wire = bus_.statistics();
  const std::uint64_t troubles = wire.troubles() - wire.time_outs;  // a servo that is away is no noise
  if (troubles != seen_troubles_) {
    seen_troubles_ = troubles;
    noisy_until_ns_ = link_.now_ns() + options_.noise_memory_ns;
  }
  return link_.now_ns() < noisy_until_ns_;
}

void PacketExchange::take_reading(std::size_t joint, Reading reading) {
  JointState& state = joints_[joint];
  const auto farthest = [](const Reading& from, const Reading& to) {
    return static_cast<double>(to.at_ns - from.at_ns) * kTopUnitsPerNs;
  };
  const auto apart = [](const Reading& one, const Reading& other) { return std::abs(one.units - other.units); };
  bool is_confirmed = reading.units <= ax12::kHighestPosition && !is_wire_noisy() && state.has_reading &&
                      apart(state.last, reading) <= farthest(state.last, reading) + kPlausibleSlackUnits;
  for (int readings = 1; !is_confirmed && readings < kMostReadings; ++readings) {
    Reading next;
    if (!read_position(joint, next)) {
      if (is_link_gone_) {
        return;
      }
      continue;
    }
    // Nothing is allowed for motion: after a retry, that would be enough room for a damaged low bit.
    is_confirmed = next.units <= ax12::kHighestPosition && next.units == reading.units;
    reading = next;
  }
  if (!is_confirmed) {
    ++report_.unconfirmed;
    return;
  }
  state.has_reading = true;
  state.last = reading;
  ++report_.positions;
  report_.joints[joint].position_deg = deg_of(map_.joints[joint], reading.units);
  report_.joints[joint].measured_ns = reading.at_ns;
}

}  // namespace tectum
