#include "drivers/servo/packet_exchange.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace tectum {
namespace {

using namespace dynamixel;

constexpr std::uint8_t kAlarms = kVoltageError | kHeatError | kOverloadError;
constexpr std::uint8_t kDisabling = kHeatError | kOverloadError;  // the factory's `shutdown`
constexpr int kMostReadings = 4;                                  // until two in succession agree
constexpr double kTopUnitsPerNs = ax12::kNoLoadSpeedDegS / ax12::kUnitDeg * 1e-9;
constexpr int kPlausibleSlackUnits = 3;  // a shaft swings a little beyond what its speed alone allows
constexpr int kWarmC = 5;                // below the limit is worth a word
constexpr int kTorqueOffSigns = 2;
constexpr int kReleaseRepeats = 3;

// [0, 19): model_number to shutdown.
constexpr std::size_t kSetupSize = 19;
// [24, 44): torque_enable to present_temperature. 26 bytes with the frame, which an ArbotiX still passes.
constexpr std::uint8_t kEverythingAt = ax12::kTorqueEnable.address;
constexpr std::size_t kEverythingSize = 20;

std::uint16_t value_in(std::span<const std::uint8_t> bytes, std::uint8_t first_address, const ax12::Register& row) {
  const std::size_t at = row.address - std::size_t{first_address};
  return row.size == 1 ? bytes[at] : word(bytes[at], bytes[at + 1]);
}

std::string seconds(TimeNs ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", static_cast<double>(ns) * 1e-9);
  return text;
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
    if (is_present(joint)) {
      get_ready(joint);
      if (health(joint) == ServoHealth::Unknown) {
        tell(joint, "does not answer");
      }
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
  const BusAnswer answer = bus_.read(id(joint), 0, setup);
  note(answer);
  if (!answer.is_ok()) {
    if (answer.status == BusStatus::NoAnswer && !state.is_told_mute) {
      state.is_told_mute = true;
      tell(joint, "answers pings only: write 2 to its status_return_level");
    }
    return;
  }
  state.answered_ns = link_.now_ns();
  state.needs_torque = true;
  state.has_goal = false;
  state.has_reading = false;
  state.torque_off_signs = 0;
  health(joint) = ServoHealth::Working;
  check_setup(joint, setup);
  if (health(joint) != ServoHealth::Working) {
    return;
  }
  // A servo that shut down before we came keeps its torque limit of 0; check_shutdown() finds it and lets it rest.
  const std::uint16_t wanted = map_.joints[joint].torque_limit;
  std::uint16_t limit = wanted;
  note(bus_.read(id(joint), ax12::kTorqueLimit, limit));
  if (limit != 0 && limit != wanted) {
    note(bus_.write(id(joint), ax12::kTorqueLimit, wanted));
  }
  if (limit == 0) {
    check_shutdown(joint);
  }
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
    joints_[joint].torque_off_signs = 0;
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
  std::array<std::uint8_t, kEverythingSize> bytes;
  const BusAnswer answer = bus_.read(id(joint), kEverythingAt, bytes);
  reading.at_ns = link_.now_ns();
  note(answer);
  if (!answer.is_ok()) {
    return false;
  }
  const auto value = [&](const ax12::Register& row) { return value_in(bytes, kEverythingAt, row); };
  reading.units = value(ax12::kPresentPosition);
  JointReport& told = report_.joints[joint];
  const std::uint16_t load = value(ax12::kPresentLoad);
  const double load_share = (load & (ax12::kDirectionBit - 1)) / 1000.0;
  told.load_share = (load & ax12::kDirectionBit) != 0 ? -load_share : load_share;
  told.supply_v = value(ax12::kPresentVoltage) / 10.0;
  told.temperature_c = value(ax12::kPresentTemperature);

  JointState& state = joints_[joint];
  const bool is_hot = told.temperature_c >= state.temperature_limit_c - kWarmC;
  if (is_hot && !state.is_told_hot) {
    tell(joint, "is at " + std::to_string(told.temperature_c) + " C and shuts down above " +
                    std::to_string(state.temperature_limit_c) + " C");
  }
  state.is_told_hot = is_hot;
  // A servo that lost its power for a moment is back before it was missed, but limp.
  const bool should_hold = report_.is_torque_on && state.has_goal && !state.needs_torque;
  state.torque_off_signs = should_hold && value(ax12::kTorqueEnable) == 0 ? state.torque_off_signs + 1 : 0;
  if (state.torque_off_signs >= kTorqueOffSigns) {
    tell(joint, "has lost its torque, as after a power cut; it is got ready again");
    get_ready(joint);
    return false;
  }
  note_answer(joint, answer);
  return !is_link_gone_;
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
    is_confirmed = next.units <= ax12::kHighestPosition && apart(reading, next) <= std::floor(farthest(reading, next));
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

// --- health --------------------------------------------------------------------------------------------------------

void PacketExchange::note_answer(std::size_t joint, const BusAnswer& answer) {
  JointState& state = joints_[joint];
  state.answered_ns = link_.now_ns();
  report_.joints[joint].error_bits = answer.error_bits;
  const std::uint8_t alarms = answer.error_bits & kAlarms;
  const auto twice = static_cast<std::uint8_t>(alarms & state.last_bits);
  const auto either = static_cast<std::uint8_t>(alarms | state.last_bits);
  state.last_bits = alarms;
  // Told when two answers in succession have it, over when two have not.
  const auto standing = static_cast<std::uint8_t>((state.told_bits & either) | twice);
  if (standing != state.told_bits) {
    tell_alarms(joint, standing);
  }
  if ((standing & kDisabling) != 0 && health(joint) == ServoHealth::Working) {
    check_shutdown(joint);
  }
}

void PacketExchange::tell_alarms(std::size_t joint, std::uint8_t bits) {
  JointState& state = joints_[joint];
  for (std::size_t bit = 0; bit < kErrorBitNames.size(); ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << bit);
    if ((bits & mask) != 0 && (state.told_bits & mask) == 0) {
      tell(joint, std::string("reports ") + kErrorBitNames[bit]);
    } else if ((bits & mask) == 0 && (state.told_bits & mask) != 0) {
      tell(joint, std::string("no longer reports ") + kErrorBitNames[bit]);
    }
  }
  state.told_bits = bits;
}

void PacketExchange::check_shutdown(std::size_t joint) {
  // Torque limit and position in one answer of four bytes, a size that nothing else has.
  std::array<std::uint8_t, 4> bytes;
  const BusAnswer answer = bus_.read(id(joint), ax12::kTorqueLimit.address, bytes);
  note(answer);
  if (!answer.is_ok() || word(bytes[0], bytes[1]) != 0) {
    return;  // an alarm that does not take its torque away is only told
  }
  JointState& state = joints_[joint];
  health(joint) = ServoHealth::ShutDown;
  state.has_goal = false;
  state.revive_at_ns = link_.now_ns() + options_.rest_ns;
  if (has_revived_too_often(state)) {
    health(joint) = ServoHealth::GivenUp;
    tell(joint, "shut down for the " + std::to_string(options_.most_revivals + 1) + "th time in " +
                    seconds(options_.revival_window_ns) + " and is left limp");
  } else {
    tell(joint, "has shut down and is limp; it is revived after " + seconds(options_.rest_ns));
  }
}

bool PacketExchange::has_revived_too_often(JointState& state) noexcept {
  int recent = 0;
  const TimeNs now_ns = link_.now_ns();
  for (std::size_t i = 0; i < std::min(state.revival_count, state.revivals_ns.size()); ++i) {
    recent += now_ns - state.revivals_ns[i] < options_.revival_window_ns ? 1 : 0;
  }
  return recent >= options_.most_revivals;
}

void PacketExchange::revive(std::size_t joint) {
  JointState& state = joints_[joint];
  const auto rest = [&] { state.revive_at_ns = link_.now_ns() + options_.rest_ns; };
  std::uint16_t temperature_c = 0;
  const BusAnswer warm = bus_.read(id(joint), ax12::kPresentTemperature, temperature_c);
  note(warm);
  if (!warm.is_ok() || !state.has_reading || temperature_c > state.temperature_limit_c - options_.cool_down_c) {
    rest();
    return;
  }
  // Its own place as goal first: with torque it must not jump to where it was told to go before. A goal may switch
  // torque on, so that a head that is to be limp gets none.
  if (report_.is_torque_on && !bus_.write(id(joint), ax12::kGoalPosition, state.last.units).is_ok()) {
    rest();
    return;
  }
  std::uint16_t limit = 0;
  if (!bus_.write(id(joint), ax12::kTorqueLimit, map_.joints[joint].torque_limit).is_ok() ||
      !bus_.read(id(joint), ax12::kTorqueLimit, limit).is_ok() || limit == 0) {
    rest();
    return;
  }
  state.revivals_ns[state.revival_count % state.revivals_ns.size()] = link_.now_ns();
  ++state.revival_count;
  state.needs_torque = true;
  state.last_bits = 0;
  state.told_bits = 0;
  health(joint) = ServoHealth::Working;
  tell(joint, "is revived: torque limit " + std::to_string(limit) + " again");
}

void PacketExchange::note_silence(std::size_t joint) {
  JointState& state = joints_[joint];
  const TimeNs silent_ns = link_.now_ns() - state.answered_ns;
  if (silent_ns >= options_.lost_after_ns) {
    health(joint) = ServoHealth::Lost;
    state.has_goal = false;
    tell(joint, "has not answered for " + seconds(silent_ns));
  }
}

void PacketExchange::come_back(std::size_t joint) {
  const ServoHealth before = health(joint);
  get_ready(joint);
  if (health(joint) == before || is_link_gone_) {
    return;
  }
  tell(joint, before == ServoHealth::Lost ? "answers again" : "has come");
}

}  // namespace tectum
