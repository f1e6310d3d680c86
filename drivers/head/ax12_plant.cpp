#include "drivers/head/ax12_plant.h"

#include <algorithm>
#include <cmath>

#include "drivers/head/random_streams.h"

namespace tectum {
namespace {

constexpr TimeNs kStepNs = 1'000'000;
constexpr double kStepS = 1e-3;

double drawn_dead_time_s(const Ax12Params& params, std::uint64_t seed, std::uint32_t servo) {
  if (!params.dead_time_drawn) {
    return params.fixed_dead_time_s;
  }
  const double share = head::unit_interval(head::draw(seed, head::Stream::ServoDeadTime, servo)[0]);
  return params.shortest_dead_time_s + share * (params.longest_dead_time_s - params.shortest_dead_time_s);
}

}  // namespace

Ax12Plant::Ax12Plant(const Ax12Params& params, JointLimits limits, std::uint64_t seed, std::uint32_t servo,
                     double start_deg)
    : unit_deg_(params.unit_deg),
      margin_deg_(params.compliance_margin_units * params.unit_deg),
      per_slope_deg_(1.0 / (params.compliance_slope_units * params.unit_deg)),
      punch_share_(params.punch_share),
      top_speed_deg_s_(params.moving_speed_deg_s > 0 ? std::min(params.moving_speed_deg_s, params.no_load_speed_deg_s)
                                                     : params.no_load_speed_deg_s),
      lag_keep_(std::exp(-kStepS / params.velocity_lag_s)),
      limits_(limits),
      dead_time_ns_(std::llround(drawn_dead_time_s(params, seed, servo) * 1e9)),
      goal_deg_(std::clamp(start_deg, limits.min_deg, limits.max_deg)),
      position_deg_(goal_deg_) {}

void Ax12Plant::command(TimeNs now_ns, double goal_deg, bool torque_on) noexcept {
  if (!std::isfinite(goal_deg)) {
    return;
  }
  if (queue_size_ == kQueue) {  // faster than the wire could be: the newest replaces the one before it
    --queue_size_;
  }
  const double limited_deg = std::clamp(goal_deg, limits_.min_deg, limits_.max_deg);
  queue_[(queue_first_ + queue_size_) % kQueue] = {now_ns + dead_time_ns_,
                                                   std::round(limited_deg / unit_deg_) * unit_deg_, torque_on};
  ++queue_size_;
}

void Ax12Plant::step(TimeNs step_ns) noexcept {
  while (queue_size_ > 0 && queue_[queue_first_].due_ns <= step_ns) {
    goal_deg_ = queue_[queue_first_].goal_deg;
    torque_on_ = queue_[queue_first_].torque_on;
    queue_first_ = (queue_first_ + 1) % kQueue;
    --queue_size_;
  }
  const double error_deg = goal_deg_ - position_deg_;
  const double beyond_deg = std::abs(error_deg) - margin_deg_;
  double drive = 0;
  if (torque_on_ && beyond_deg > 0) {
    drive = std::copysign(std::min(1.0, punch_share_ + beyond_deg * per_slope_deg_), error_deg);
  }
  // Exact for a drive held over the step.
  const double aim_deg_s = drive * top_speed_deg_s_;
  velocity_deg_s_ = aim_deg_s + (velocity_deg_s_ - aim_deg_s) * lag_keep_;
  position_deg_ += velocity_deg_s_ * kStepS;
  if (position_deg_ < limits_.min_deg || position_deg_ > limits_.max_deg) {
    position_deg_ = std::clamp(position_deg_, limits_.min_deg, limits_.max_deg);
    velocity_deg_s_ = 0;
  }
}

void Ax12Plant::advance_to(TimeNs now_ns) noexcept {
  while (time_ns_ + kStepNs <= now_ns) {
    time_ns_ += kStepNs;
    step(time_ns_);
  }
}

double Ax12Plant::position_deg(TimeNs now_ns) const noexcept {
  const double ahead_s = static_cast<double>(now_ns - time_ns_) * 1e-9;
  return std::clamp(position_deg_ + velocity_deg_s_ * ahead_s, limits_.min_deg, limits_.max_deg);
}

double Ax12Plant::measured_deg(TimeNs now_ns) const noexcept {
  return std::round(position_deg(now_ns) / unit_deg_) * unit_deg_;
}

}  // namespace tectum
