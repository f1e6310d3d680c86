#include "drivers/servo/emulated_sketch.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "drivers/servo/ax12_registers.h"

namespace tectum {
namespace {

constexpr TimeNs kByteNs = 10LL * 1'000'000'000 / sketch::kBaud;
constexpr TimeNs kNeckStepNs = 1'000'000;  // one unit
constexpr TimeNs kLoopDelayNs = 5'000'000;
constexpr std::size_t kNeckFields = 2;

bool is_in_gate(int units) { return units > 340 && units < 700; }

}  // namespace

void EmulatedSketch::receive(TimeNs now_ns, std::span<const std::uint8_t> bytes) {
  host_end_ns_ = std::max(host_end_ns_, now_ns);
  if (host_baud_ != sketch::kBaud || is_hung_) {
    return;
  }
  for (const std::uint8_t byte : bytes) {
    host_end_ns_ += kByteNs;
    if (byte != '\n') {
      line_ += static_cast<char>(byte);
      continue;
    }
    busy_until_ns_ = std::max(busy_until_ns_, host_end_ns_);
    obey(line_);
    line_.clear();
  }
}

void EmulatedSketch::obey(const std::string& line) {
  ++lines_;
  std::array<int, sketch::kFields> wanted{};
  std::size_t at = 0;
  for (int& units : wanted) {
    units = std::atoi(line.c_str() + std::min(at, line.size()));  // a missing field reads as 0, as in the program
    const std::size_t comma = line.find(',', at);
    at = comma == std::string::npos ? line.size() : comma + 1;
  }
  const TimeNs before_ns = busy_until_ns_;
  for (std::size_t field = 0; field < kNeckFields; ++field) {
    if (!is_in_gate(wanted[field])) {
      is_hung_ = true;
      return;
    }
    walk_neck(field, wanted[field]);
  }
  longest_neck_move_ns_ = std::max(longest_neck_move_ns_, busy_until_ns_ - before_ns);
  for (std::size_t field = kNeckFields; field < sketch::kFields; ++field) {
    if (is_in_gate(wanted[field])) {
      drive(field, wanted[field]);
    }
  }
  answer();
}

void EmulatedSketch::walk_neck(std::size_t field, int goal_units) {
  while (goal_units_[field] != goal_units) {
    drive(field, goal_units_[field] + (goal_units > goal_units_[field] ? 1 : -1));
    busy_until_ns_ += kNeckStepNs;
  }
}

void EmulatedSketch::drive(std::size_t field, int goal_units) {
  goal_units_[field] = goal_units;
  ServoDrive wanted;
  wanted.goal_deg = goal_units * ax12::kUnitDeg;
  wanted.torque_share = 1;
  wanted.cw_margin_deg = wanted.ccw_margin_deg = ax12::kUnitDeg;
  wanted.punch_share = 32 / 1023.0;
  motions_[field].drive(busy_until_ns_, wanted);
}

double EmulatedSketch::position_units(Joint joint, TimeNs now_ns) noexcept {
  const auto field = static_cast<std::size_t>(
      std::find(sketch::kFieldJoints.begin(), sketch::kFieldJoints.end(), joint) - sketch::kFieldJoints.begin());
  return motions_[field].shaft(now_ns).position_deg / ax12::kUnitDeg;
}

void EmulatedSketch::answer() {
  std::string text;
  for (Ax12Motion& motion : motions_) {
    const long units = std::lround(motion.shaft(busy_until_ns_).position_deg / ax12::kUnitDeg);
    text += (text.empty() ? "" : ",") + std::to_string(units);
  }
  text += "\n\n";
  for (const char character : text) {
    busy_until_ns_ += kByteNs;
    outgoing_.push_back({busy_until_ns_, static_cast<std::uint8_t>(character)});
  }
  busy_until_ns_ += kLoopDelayNs;
}

TimeNs EmulatedSketch::next_ns() const { return outgoing_.empty() ? kNever : outgoing_.front().end_ns; }

std::size_t EmulatedSketch::transmit(TimeNs now_ns, std::span<std::uint8_t> out) {
  std::size_t count = 0;
  while (count < out.size() && !outgoing_.empty() && outgoing_.front().end_ns <= now_ns) {
    out[count++] = outgoing_.front().value;
    outgoing_.pop_front();
  }
  return count;
}

}  // namespace tectum
