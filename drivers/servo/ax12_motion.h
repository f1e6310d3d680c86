// The emulated bus's own model of an AX-12A's motor and gears, stepped at 1 kHz like the servo's control interrupt.
//
//   e = goal - p,   m, s = compliance margin and slope on e's side
//   u = 0                                         |e| <= m
//   u = sign(e) min(T, punch + (|e| - m)/s)       otherwise            T = torque limit
//   tau dv/dt = u v_supply - v,   |v| <= min(moving speed, v_supply)
//   dp/dt = v
//   v_supply = 354 deg/s * supply / 12 V
//
// A goal takes its dead time to arrive. A limp motor is held by its gears: 254:1 does not turn back under its own load.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/servo/servo_motion.h"

namespace tectum {

struct Ax12MotionParams {
  double start_deg = 512 * (300.0 / 1023.0);  // the middle, as the servo counts
  double dead_time_s = 0.030;                 // Smith & Jivraj, Robotis forum thread 1148: 17.4 to 50.2 ms
  double velocity_lag_s = 0.020;              // not published; as in drivers/head
};

class Ax12Motion final : public ServoMotion {
 public:
  explicit Ax12Motion(const Ax12MotionParams& params = {}) noexcept;

  void drive(TimeNs now_ns, const ServoDrive& drive) noexcept override;
  [[nodiscard]] ShaftState shaft(TimeNs now_ns) noexcept override;

  /// Holds the shaft where it is, whatever the motor does: the way to an overload.
  void block(bool is_blocked) noexcept { is_blocked_ = is_blocked; }
  /// A hand turns the shaft, and lets go.
  void turn_to(double position_deg) noexcept;

 private:
  struct Pending {
    TimeNs due_ns = 0;
    ServoDrive drive;
  };
  void advance_to(TimeNs now_ns) noexcept;
  void step() noexcept;
  [[nodiscard]] double motor_share() const noexcept;

  static constexpr std::uint32_t kQueue = 64;  // one a millisecond through the longest dead time
  std::array<Pending, kQueue> queue_{};
  std::uint32_t queue_first_ = 0;
  std::uint32_t queue_size_ = 0;

  TimeNs dead_time_ns_;
  double lag_keep_;  // exp(-h / tau)
  ServoDrive drive_;
  ShaftState state_;
  TimeNs time_ns_ = 0;
  bool has_time_ = false;
  bool is_blocked_ = false;
};

}  // namespace tectum
