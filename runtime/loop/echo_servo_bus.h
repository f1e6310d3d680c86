// A bus without servos, for runs on recorded video: every joint is at once where it was told to be.
#pragma once

#include "runtime/ports/servo_bus.h"

namespace tectum {

class EchoServoBus final : public ServoBus {
 public:
  [[nodiscard]] bool write(const ServoCommand& command) noexcept override {
    position_deg_ = command.goal_deg;
    return true;
  }
  void read(TimeNs now_ns, ServoFeedback& out) noexcept override {
    out = {.measured_ns = now_ns, .position_deg = position_deg_, .fresh_mask = (1U << kJointCount) - 1};
  }

 private:
  std::array<double, kJointCount> position_deg_{};
};

}  // namespace tectum
