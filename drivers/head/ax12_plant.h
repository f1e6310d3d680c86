// One AX-12A servo as the loop sees it: late, quantised, slew-limited, and a little soft.
//
//   goal written  --dead time-->  goal held by the servo, in units of 300/1023 deg
//   e = goal - p
//   u = 0                                            |e| <= margin               (compliance margin)
//   u = sign(e) min(1, punch + (|e| - margin)/slope)  otherwise                  (punch, compliance slope)
//   tau dv/dt = u v_max - v,   |v| <= v_max           v_max = min(moving speed, no-load speed)
//   dp/dt = v                                         within the joint's limits
//
// Stepped at 1 kHz, the rate of the servo's own control interrupt.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/head/geometry.h"
#include "runtime/ports/frame.h"

namespace tectum {

/// Sources: emanual = ROBOTIS e-manual, AX-12A control table; Smith = Smith & Jivraj, Robotis forum thread 1148
/// (17.4 to 50.2 ms from command to motion); Xevel = xevelabs.com USB2AX notes (1 kHz control interrupt).
struct Ax12Params {
  double unit_deg = 300.0 / 1023.0;     // emanual: 0 to 1023 over 300 deg
  double no_load_speed_deg_s = 354;     // emanual: 59 rpm at 12 V
  double moving_speed_deg_s = 0;        // register 32; 0 = as fast as it can
  double compliance_margin_units = 1;   // emanual, registers 26 and 27
  double compliance_slope_units = 32;   // emanual, registers 28 and 29
  double punch_share = 32.0 / 1023.0;   // emanual, register 48, of full drive
  double velocity_lag_s = 0.020;        // motor and gear train; not documented, chosen within 20 to 40 ms
  double shortest_dead_time_s = 0.017;  // Smith
  double longest_dead_time_s = 0.050;   // Smith
  bool dead_time_drawn = true;          // once for each servo from the seed; otherwise fixed_dead_time_s
  double fixed_dead_time_s = 0.030;
};

class Ax12Plant {
 public:
  /// `servo` keeps the draws of the servos of one seed apart. At rest at `start_deg`.
  Ax12Plant(const Ax12Params& params, JointLimits limits, std::uint64_t seed, std::uint32_t servo,
            double start_deg = 0);

  /// The newest goal wins once its dead time has passed. Angles that are not finite are ignored.
  void command(TimeNs now_ns, double goal_deg, bool torque_on) noexcept;
  /// Runs the servo's loop up to and including `now_ns`. Time never runs backwards.
  void advance_to(TimeNs now_ns) noexcept;

  /// The shaft at `now_ns`, at most one step after the last advance.
  [[nodiscard]] double position_deg(TimeNs now_ns) const noexcept;
  /// What the servo reports: in whole units.
  [[nodiscard]] double measured_deg(TimeNs now_ns) const noexcept;
  [[nodiscard]] double dead_time_s() const noexcept { return static_cast<double>(dead_time_ns_) * 1e-9; }

 private:
  struct Pending {
    TimeNs due_ns = 0;
    double goal_deg = 0;
    bool torque_on = true;
  };
  void step(TimeNs step_ns) noexcept;

  // Commands on their way: enough for one a millisecond through the longest dead time.
  static constexpr std::uint32_t kQueue = 64;
  std::array<Pending, kQueue> queue_{};
  std::uint32_t queue_first_ = 0;
  std::uint32_t queue_size_ = 0;

  double unit_deg_;
  double margin_deg_;
  double per_slope_deg_;
  double punch_share_;
  double top_speed_deg_s_;
  double lag_keep_;  // exp(-h / tau)
  JointLimits limits_;
  TimeNs dead_time_ns_;

  TimeNs time_ns_ = 0;
  double goal_deg_;
  bool torque_on_ = true;
  double position_deg_;
  double velocity_deg_s_ = 0;
};

}  // namespace tectum
