#include "tools/live/head_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tectum {
namespace {

class HeadMotion final : public ServoMotion {
 public:
  HeadMotion(SimHead& head, std::mutex& mutex, const ServoMap& map, Joint joint, TimeNs start_ns)
      : head_(head),
        mutex_(mutex),
        mapped_(map.joints[index_of(joint)]),
        joint_(index_of(joint)),
        start_ns_(start_ns) {}

  void drive(TimeNs now_ns, const ServoDrive& drive) noexcept override {
    const double units = drive.goal_deg / ax12::kUnitDeg;
    ServoCommand command;
    command.goal_deg.fill(std::numeric_limits<double>::quiet_NaN());  // which leaves the other joints alone
    command.goal_deg[joint_] = mapped_.direction * (units - mapped_.home_units) * mapped_.deg_per_unit;
    command.torque_on = drive.torque_share > 0;
    const std::lock_guard lock(mutex_);
    advance(now_ns);
    (void)head_.write(command);
  }

  [[nodiscard]] ShaftState shaft(TimeNs now_ns) noexcept override {
    const std::lock_guard lock(mutex_);
    advance(now_ns);
    ServoFeedback feedback;
    head_.read(head_.now_ns(), feedback);
    const double units = mapped_.home_units + mapped_.direction * feedback.position_deg[joint_] / mapped_.deg_per_unit;
    ShaftState state;
    state.position_deg = units * ax12::kUnitDeg;
    if (now_ns > last_ns_) {
      speed_deg_s_ = (state.position_deg - last_deg_) / (static_cast<double>(now_ns - last_ns_) * 1e-9);
      last_ns_ = now_ns;
      last_deg_ = state.position_deg;
    }
    state.speed_deg_s = speed_deg_s_;
    return state;
  }

 private:
  void advance(TimeNs now_ns) noexcept { head_.sleep_until(std::max<TimeNs>(now_ns - start_ns_, head_.now_ns())); }

  SimHead& head_;
  std::mutex& mutex_;
  ServoJoint mapped_;
  std::size_t joint_;
  TimeNs start_ns_;
  TimeNs last_ns_ = 0;
  double last_deg_ = 150;
  double speed_deg_s_ = 0;
};

}  // namespace

std::unique_ptr<ServoMotion> make_head_motion(SimHead& head, std::mutex& mutex, const ServoMap& map, Joint joint,
                                              TimeNs start_ns) {
  return std::make_unique<HeadMotion>(head, mutex, map, joint, start_ns);
}

}  // namespace tectum
