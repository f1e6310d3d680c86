// What a PacketExchange makes of a servo's alarms and silences.
#include <algorithm>
#include <cstdio>

#include "drivers/servo/packet_exchange.h"

namespace tectum {
namespace {

using namespace dynamixel;

constexpr std::uint8_t kAlarms = kVoltageError | kHeatError | kOverloadError;
constexpr std::uint8_t kDisabling = kHeatError | kOverloadError;  // the factory's `shutdown`

std::string seconds(TimeNs ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", static_cast<double>(ns) * 1e-9);
  return text;
}

}  // namespace

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
  const BusAnswer answer = read_surely(joint, ax12::kTorqueLimit.address, bytes);
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
  std::uint8_t temperature_c = 0;
  const BusAnswer warm = read_surely(joint, ax12::kPresentTemperature.address, std::span(&temperature_c, 1));
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
