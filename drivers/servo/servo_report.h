// What the driver knows of the servos, and what it tells people.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/servo/ax12_bus.h"
#include "runtime/ports/servo_command.h"

namespace tectum {

enum class ServoHealth : std::uint8_t {
  Unknown,  // never answered, or not part of the head
  Working,
  Lost,      // answered once, and no longer does
  ShutDown,  // its own alarm took its torque away; will be revived
  GivenUp,   // shut down again and again, or set up so that it cannot be used; left alone
};
inline constexpr std::array<const char*, 5> kServoHealthNames = {"unknown", "working", "lost", "shut down", "given up"};

struct JointReport {
  ServoHealth health = ServoHealth::Unknown;
  double position_deg = 0;  // the last that was confirmed
  TimeNs measured_ns = 0;   // when; 0 = never
  double load_share = 0;    // -1 to 1
  double supply_v = 0;
  int temperature_c = 0;
  std::uint8_t error_bits = 0;  // of its last answer
};

struct HeadReport {
  std::array<JointReport, kJointCount> joints{};
  bool is_connected = false;
  bool is_torque_on = false;
  std::uint64_t commands = 0;     // sent
  std::uint64_t rounds = 0;       // times that every servo was asked
  std::uint64_t positions = 0;    // taken as right
  std::uint64_t unconfirmed = 0;  // thrown away: a second reading did not say the same
  std::uint64_t reconnections = 0;
  BusStatistics wire;
};

struct ServoEvent {
  TimeNs at_ns = 0;
  std::string text;  // one line: "servo 3 (left_eye_pan) has not answered for 0.2 s"
};

/// Written by the driver's thread, read by anybody. Keeps the oldest when it is full, and counts the rest.
class ServoEventLog {
 public:
  void add(TimeNs at_ns, std::string text) {
    const std::lock_guard lock(mutex_);
    if (events_.size() < kMostEvents) {
      events_.push_back({at_ns, std::move(text)});
    } else {
      ++dropped_;
    }
  }
  [[nodiscard]] std::vector<ServoEvent> take() {
    const std::lock_guard lock(mutex_);
    std::vector<ServoEvent> taken;
    taken.swap(events_);
    if (dropped_ > 0) {
      taken.push_back({taken.back().at_ns, std::to_string(dropped_) + " more events were not kept"});
      dropped_ = 0;
    }
    return taken;
  }

 private:
  static constexpr std::size_t kMostEvents = 1000;
  std::mutex mutex_;
  std::vector<ServoEvent> events_;
  std::uint64_t dropped_ = 0;
};

}  // namespace tectum
