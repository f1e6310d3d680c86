#include "drivers/servo/ax12_motion.h"

#include <algorithm>
#include <cmath>

#include "drivers/servo/ax12_registers.h"

namespace tectum {
namespace {

constexpr TimeNs kStepNs = 1'000'000;
constexpr double kStepS = 1e-3;
constexpr double kRatedSupplyV = 12;
// Once it moves slower than this towards nothing, the shaft is taken to be at rest and costs no more steps.
constexpr double kRestSpeedDegS = 1e-3;

}  // namespace

Ax12Motion::Ax12Motion(const Ax12MotionParams& params) noexcept
    : dead_time_ns_(std::llround(params.dead_time_s * 1e9)), lag_keep_(std::exp(-kStepS / params.velocity_lag_s)) {
  state_.position_deg = params.start_deg;
  drive_.goal_deg = params.start_deg;
}

void Ax12Motion::drive(TimeNs now_ns, const ServoDrive& drive) noexcept {
  advance_to(now_ns);
  if (queue_size_ == kQueue) {  // the newest replaces the one before it
    --queue_size_;
  }
  queue_[(queue_first_ + queue_size_) % kQueue] = {now_ns + dead_time_ns_, drive};
  ++queue_size_;
}

ShaftState Ax12Motion::shaft(TimeNs now_ns) noexcept {
  advance_to(now_ns);
  return state_;
}

void Ax12Motion::turn_to(double position_deg) noexcept {
  state_.position_deg = position_deg;
  state_.speed_deg_s = 0;
}

void Ax12Motion::advance_to(TimeNs now_ns) noexcept {
  if (!has_time_) {
    has_time_ = true;
    time_ns_ = now_ns;
    return;
  }
  while (time_ns_ + kStepNs <= now_ns) {
    const bool is_at_rest = queue_size_ == 0 && std::abs(state_.speed_deg_s) < kRestSpeedDegS && motor_share() == 0;
    if (is_at_rest) {
      time_ns_ += (now_ns - time_ns_) / kStepNs * kStepNs;
      state_.speed_deg_s = 0;
      state_.load_share = 0;
      return;
    }
    time_ns_ += kStepNs;
    step();
  }
}

double Ax12Motion::motor_share() const noexcept {
  if (drive_.is_wheel) {
    return std::clamp(drive_.wheel_share, -drive_.torque_share, drive_.torque_share);
  }
  const double error_deg = drive_.goal_deg - state_.position_deg;
  const bool is_ccw = error_deg > 0;
  const double beyond_deg = std::abs(error_deg) - (is_ccw ? drive_.ccw_margin_deg : drive_.cw_margin_deg);
  if (beyond_deg <= 0 || drive_.torque_share <= 0) {
    return 0;
  }
  const double slope_deg = is_ccw ? drive_.ccw_slope_deg : drive_.cw_slope_deg;
  return std::copysign(std::min(drive_.torque_share, drive_.punch_share + beyond_deg / slope_deg), error_deg);
}

void Ax12Motion::step() noexcept {
  while (queue_size_ > 0 && queue_[queue_first_].due_ns <= time_ns_) {
    drive_ = queue_[queue_first_].drive;
    queue_first_ = (queue_first_ + 1) % kQueue;
    --queue_size_;
  }
  const double share = motor_share();
  state_.load_share = share;
  if (is_blocked_) {
    state_.speed_deg_s = 0;
    return;
  }
  const double supply_speed_deg_s = ax12::kNoLoadSpeedDegS * drive_.supply_v / kRatedSupplyV;
  double top_deg_s = supply_speed_deg_s;
  if (!drive_.is_wheel && drive_.speed_deg_s > 0) {
    top_deg_s = std::min(top_deg_s, drive_.speed_deg_s);
  }
  // Exact for a drive held over the step.
  const double aim_deg_s = std::clamp(share * supply_speed_deg_s, -top_deg_s, top_deg_s);
  state_.speed_deg_s = aim_deg_s + (state_.speed_deg_s - aim_deg_s) * lag_keep_;
  state_.position_deg += state_.speed_deg_s * kStepS;
  if (drive_.is_wheel) {
    state_.position_deg = std::fmod(state_.position_deg + 360.0, 360.0);
  } else if (state_.position_deg < 0 || state_.position_deg > 300) {
    state_.position_deg = std::clamp(state_.position_deg, 0.0, 300.0);
    state_.speed_deg_s = 0;
  }
}

}  // namespace tectum
