#include "runtime/act/servo_guard.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tectum {
namespace {

// A stop goes to the measured angle only while that is recent; at 354 deg/s an older one would be a jump backwards.
constexpr TimeNs kStopMeasuredWithinNs = 50'000'000;
// One unit of an AX-12A's goal position (e-manual, Goal Position): a joint that is nearer than that has caught up.
// Otherwise a head that stands where its circuit wants it would still be approached, and slowed in its first saccade.
constexpr double kServoUnitDeg = 300.0 / 1023;
constexpr TimeNs kEver = std::numeric_limits<TimeNs>::min();

/// `from` moved towards `to` by at most `step`.
double moved(double from, double to, double step) noexcept {
  if (std::abs(to - from) <= step) {
    return to;  // exactly: from + (to - from) may round beside it
  }
  return to > from ? from + step : from - step;
}

bool is_latched(GuardState state) noexcept {
  return state == GuardState::Parking || state == GuardState::Stopped || state == GuardState::Released;
}

}  // namespace

ServoGuard::ServoGuard(const SpikeImage& image, const GuardOptions& options) : options_(options) {
  for (const JointRecord& record : image.joints) {
    const auto j = static_cast<std::size_t>(record.joint);
    GuardedJoint& joint = joints_[j];
    joint.is_driven = true;
    joint.min_deg = std::min(record.min_deg, record.max_deg);
    joint.max_deg = std::max(record.min_deg, record.max_deg);
    joint.max_speed_deg_s = record.max_speed_deg_s;
    joint.neutral_deg = std::clamp(options.neutral_deg[j], joint.min_deg, joint.max_deg);
  }
}

bool ServoGuard::decide(const GuardInput& input, ServoCommand& command) noexcept {
  const TimeNs since_last_ns = has_last_ns_ ? input.now_ns - last_ns_ : 0;
  last_ns_ = input.now_ns;
  has_last_ns_ = true;
  const TimeNs dt_ns = std::clamp<TimeNs>(since_last_ns, 0, options_.max_step_ns);
  counters_.clock_jumps += dt_ns != since_last_ns ? 1 : 0;

  take_feedback(input);
  const bool was_waiting = state_ == GuardState::Waiting;
  change_state(input);
  if (state_ == GuardState::Waiting) {
    return false;
  }
  move(input, was_waiting ? 0.0 : static_cast<double>(dt_ns) * 1e-9);
  command.issued_ns = input.now_ns;
  command.torque_on = state_ != GuardState::Released;
  command.joint_mask = 0;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    command.goal_deg[j] = joints_[j].goal_deg;
    command.joint_mask |= joints_[j].is_driven || joints_[j].is_measured ? 1U << j : 0U;
  }
  return true;
}

void ServoGuard::take_feedback(const GuardInput& input) noexcept {
  for (std::size_t j = 0; j < kJointCount; ++j) {
    GuardedJoint& joint = joints_[j];
    const double position_deg = input.feedback.position_deg[j];
    const bool is_fresh = (input.feedback.fresh_mask >> j & 1U) != 0 && std::isfinite(position_deg);
    if (is_fresh) {
      const bool is_first = !joint.is_measured;
      joint.measured_deg = position_deg;
      joint.measured_ns = input.now_ns;
      joint.is_measured = true;
      if (joint.is_lost || (is_first && !joint.is_driven)) {
        joint.is_lost = false;
        joint.is_gentle = true;
        joint.goal_deg = position_deg;
      }
    } else if (joint.is_driven && joint.is_measured && !joint.is_lost &&
               input.now_ns - joint.measured_ns >= options_.servo_lost_after_ns) {
      joint.is_lost = true;
      ++counters_.losses;
    }
  }
}

void ServoGuard::change_state(const GuardInput& input) noexcept {
  if (input.request == GuardRequest::Release) {
    state_ = GuardState::Released;
  } else if (input.request == GuardRequest::Stop && state_ != GuardState::Released && state_ != GuardState::Stopped) {
    // Before the joints are measured there is nowhere to stop at, and nothing has been sent: wait, and stop then.
    if (state_ != GuardState::Waiting || all_measured()) {
      start_from_measured(state_ == GuardState::Waiting ? kEver : input.now_ns - kStopMeasuredWithinNs);
      state_ = GuardState::Stopped;
    }
    return;
  } else if (input.request == GuardRequest::Park && !is_latched(state_) &&
             (state_ != GuardState::Waiting || all_measured())) {
    if (state_ == GuardState::Waiting) {
      start_from_measured(kEver);
    }
    state_ = GuardState::Parking;
  }
  if (is_latched(state_)) {
    return;
  }
  if (state_ == GuardState::Waiting) {
    if (!all_measured()) {
      return;
    }
    start_from_measured(kEver);
    state_ = GuardState::Approaching;
  }
  const bool is_following = state_ == GuardState::Approaching || state_ == GuardState::Tracking;
  if (is_following && input.camera_age_ns >= options_.hold_after_ns) {
    state_ = GuardState::Holding;
    ++counters_.holds;
  }
  if (state_ == GuardState::Holding && input.camera_age_ns >= options_.ease_after_ns) {
    state_ = GuardState::Easing;
  }
  if (!is_following && input.camera_age_ns < options_.hold_after_ns) {
    state_ = GuardState::Approaching;
    for (GuardedJoint& joint : joints_) {
      joint.is_gentle = true;
    }
  }
}

void ServoGuard::start_from_measured(TimeNs measured_since_ns) noexcept {
  for (GuardedJoint& joint : joints_) {
    joint.is_gentle = true;
    if (joint.is_measured && joint.measured_ns >= measured_since_ns) {
      joint.goal_deg = joint.measured_deg;
    }
  }
}

void ServoGuard::move(const GuardInput& input, double dt_s) noexcept {
  is_at_neutral_ = true;
  bool all_caught_up = true;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    GuardedJoint& joint = joints_[j];
    if (!joint.is_driven || joint.is_lost) {
      continue;
    }
    if (state_ == GuardState::Easing || state_ == GuardState::Parking) {
      joint.goal_deg = moved(joint.goal_deg, joint.neutral_deg, options_.ease_speed_deg_s * dt_s);
    } else if (state_ == GuardState::Approaching || state_ == GuardState::Tracking) {
      follow(joint, input.decoded_deg[j], dt_s);
    }
    is_at_neutral_ = is_at_neutral_ && joint.goal_deg == joint.neutral_deg;
    all_caught_up = all_caught_up && !joint.is_gentle;
  }
  if (state_ == GuardState::Approaching || state_ == GuardState::Tracking) {
    state_ = all_caught_up ? GuardState::Tracking : GuardState::Approaching;
  }
}

void ServoGuard::follow(GuardedJoint& joint, double decoded_deg, double dt_s) noexcept {
  if (!std::isfinite(decoded_deg)) {
    ++counters_.not_finite;
    return;
  }
  const double wanted_deg = std::clamp(decoded_deg, joint.min_deg, joint.max_deg);
  counters_.limited += wanted_deg != decoded_deg ? 1 : 0;
  const bool has_limit = joint.max_speed_deg_s > 0;
  if (joint.is_gentle) {
    const double speed_deg_s =
        has_limit ? std::min(joint.max_speed_deg_s, options_.approach_speed_deg_s) : options_.approach_speed_deg_s;
    joint.goal_deg = moved(joint.goal_deg, wanted_deg, speed_deg_s * dt_s);
    joint.is_gentle = std::abs(wanted_deg - joint.goal_deg) > kServoUnitDeg;
  } else {
    joint.goal_deg = has_limit ? moved(joint.goal_deg, wanted_deg, joint.max_speed_deg_s * dt_s) : wanted_deg;
  }
  counters_.slewed += joint.goal_deg != wanted_deg ? 1 : 0;
}

bool ServoGuard::all_measured() const noexcept {
  return std::all_of(joints_.begin(), joints_.end(),
                     [](const GuardedJoint& joint) { return joint.is_measured || !joint.is_driven; });
}

void ServoGuard::resume() noexcept {
  if (!is_latched(state_)) {
    return;
  }
  state_ = GuardState::Waiting;
  for (GuardedJoint& joint : joints_) {
    joint.is_measured = false;
    joint.is_lost = false;
  }
}

std::uint32_t ServoGuard::lost_mask() const noexcept {
  std::uint32_t mask = 0;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const GuardedJoint& joint = joints_[j];
    if (joint.is_driven && (joint.is_lost || !joint.is_measured)) {
      mask |= 1U << j;
    }
  }
  return mask;
}

}  // namespace tectum
