#include "drivers/servo/sketch_exchange.h"

#include <algorithm>
#include <cstdlib>

namespace tectum {
namespace {

constexpr double kSlackUnits = 3;

bool is_neck(std::size_t joint) {
  return joint == static_cast<std::size_t>(Joint::NeckPan) || joint == static_cast<std::size_t>(Joint::NeckTilt);
}

}  // namespace

SketchExchange::SketchExchange(ByteLink& link, const ServoMap& map, const SketchExchangeOptions& options,
                               HeadReport& report, ServoEventLog& events)
    : link_(link), map_(map), options_(options), report_(report), events_(events) {
  for (ServoJoint& joint : map_.joints) {
    joint.min_units = std::max(joint.min_units, sketch::kLowestUnits);
    joint.max_units = std::min(joint.max_units, sketch::kHighestUnits);
  }
}

ExchangeStatus SketchExchange::begin() {
  link_.discard_input();
  parser_.clear();
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    goal_units_[joint] = units_of(map_.joints[joint], 0).value_or(512);
  }
  sent_units_ = goal_units_;
  answered_ns_ = link_.now_ns();
  report_.is_torque_on = true;
  // Twice: the second answer confirms the first.
  ExchangeStatus status = exchange_line(goal_units_, options_.first_answer_timeout_ns);
  if (status != ExchangeStatus::LinkGone && read_ns_ != 0) {
    status = exchange_line(goal_units_, options_.first_answer_timeout_ns);
  }
  report_.is_connected = status != ExchangeStatus::LinkGone;
  if (report_.is_connected && report_.positions == 0) {
    events_.add(link_.now_ns(), "the head's board does not answer; is the 2020 program on it, at 57600 baud?");
  }
  return status == ExchangeStatus::LinkGone ? status : ExchangeStatus::RoundOver;
}

ExchangeStatus SketchExchange::send(const ServoCommand& command) {
  ++report_.commands;
  if (!command.torque_on) {
    release();
    return ExchangeStatus::Busy;
  }
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    if ((command.joint_mask >> joint & 1U) != 0) {
      goal_units_[joint] = units_of(map_.joints[joint], command.goal_deg[joint]).value_or(goal_units_[joint]);
    }
  }
  return ExchangeStatus::Busy;
}

sketch::JointUnits SketchExchange::next_units() const noexcept {
  sketch::JointUnits units = goal_units_;
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    if (is_neck(joint)) {
      const int step = std::clamp(goal_units_[joint] - sent_units_[joint], -options_.max_neck_step_units,
                                  options_.max_neck_step_units);
      units[joint] = static_cast<std::uint16_t>(sent_units_[joint] + step);
    }
  }
  return units;
}

ExchangeStatus SketchExchange::poll() {
  // The same goals again when there is no new command: the answer is the only way to measure.
  const ExchangeStatus status = exchange_line(next_units(), options_.answer_timeout_ns);
  if (status == ExchangeStatus::LinkGone) {
    report_.is_connected = false;
    return status;
  }
  ++report_.rounds;
  return ExchangeStatus::RoundOver;
}

ExchangeStatus SketchExchange::exchange_line(const sketch::JointUnits& units, TimeNs timeout_ns) {
  ++report_.wire.requests;
  const std::string line = sketch::encode_line(units);
  if (!link_.write(std::span(reinterpret_cast<const std::uint8_t*>(line.data()), line.size()))) {
    return ExchangeStatus::LinkGone;
  }
  sent_units_ = units;
  const TimeNs deadline_ns = link_.now_ns() + timeout_ns;
  for (;;) {
    std::array<std::uint8_t, 128> bytes;
    std::size_t count = 0;
    switch (link_.read(bytes, count, deadline_ns)) {
      case LinkRead::Gone:
        return ExchangeStatus::LinkGone;
      case LinkRead::Bytes:
        if (const auto answer = parser_.push(std::span(bytes).first(count))) {
          take(*answer);
          return ExchangeStatus::RoundOver;
        }
        break;
      case LinkRead::TimedOut:
        ++report_.wire.time_outs;
        parser_.clear();
        if (!is_lost_ && report_.positions > 0 && link_.now_ns() - answered_ns_ >= options_.lost_after_ns) {
          is_lost_ = true;
          for (JointReport& joint : report_.joints) {
            joint.health = ServoHealth::Lost;
          }
          events_.add(link_.now_ns(), "the head's board no longer answers");
        }
        return ExchangeStatus::RoundOver;
    }
  }
}

void SketchExchange::take(const sketch::JointUnits& units) {
  answered_ns_ = link_.now_ns();
  if (is_lost_) {
    is_lost_ = false;
    events_.add(answered_ns_, "the head's board answers again");
  }
  const double farthest_units =
      static_cast<double>(answered_ns_ - read_ns_) * 1e-9 * ax12::kNoLoadSpeedDegS / ax12::kUnitDeg + kSlackUnits;
  const bool is_first = read_ns_ == 0;
  read_ns_ = answered_ns_;
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    const int moved_units = std::abs(units[joint] - read_units_[joint]);
    read_units_[joint] = units[joint];
    JointReport& told = report_.joints[joint];
    if (is_first || moved_units > farthest_units) {
      ++report_.unconfirmed;
      continue;
    }
    ++report_.positions;
    told.health = ServoHealth::Working;
    told.position_deg = deg_of(map_.joints[joint], units[joint]);
    told.measured_ns = answered_ns_;
  }
}

void SketchExchange::release() {
  if (!is_told_of_torque_) {
    is_told_of_torque_ = true;
    events_.add(link_.now_ns(), "the head's own program cannot switch torque off: cut the servos' power");
  }
}

}  // namespace tectum
