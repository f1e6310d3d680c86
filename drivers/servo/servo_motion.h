// What turns an emulated servo's shaft. The registers say what the motor is asked for; a motion answers where the shaft
// is. Another model, such as the simulated head's, goes behind the emulated bus by implementing this.
#pragma once

#include "runtime/ports/frame.h"

namespace tectum {

/// What the servo's registers ask of its motor. Angles in degrees from the servo's own 0, counter-clockwise.
struct ServoDrive {
  double goal_deg = 150;
  double speed_deg_s = 0;   // 0 = as fast as it can
  double torque_share = 0;  // 0 = limp, 1 = all it has
  double cw_margin_deg = 0;
  double ccw_margin_deg = 0;
  double cw_slope_deg = 9.4;
  double ccw_slope_deg = 9.4;
  double punch_share = 0;
  bool is_wheel = false;   // turns for ever at wheel_share of its torque; the goal means nothing
  double wheel_share = 0;  // -1 to 1, counter-clockwise positive
  double supply_v = 11.1;
};

struct ShaftState {
  double position_deg = 150;
  double speed_deg_s = 0;
  double load_share = 0;  // of all the torque there is, -1 to 1: what the motor does against the load
};

class ServoMotion {
 public:
  ServoMotion() = default;
  ServoMotion(const ServoMotion&) = delete;
  ServoMotion& operator=(const ServoMotion&) = delete;
  virtual ~ServoMotion() = default;

  /// From `now_ns` on. Time never runs backwards.
  virtual void drive(TimeNs now_ns, const ServoDrive& drive) noexcept = 0;
  [[nodiscard]] virtual ShaftState shaft(TimeNs now_ns) noexcept = 0;
};

}  // namespace tectum
