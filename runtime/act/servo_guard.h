// The one place that decides what is safe to send to the servos.
//
// States, and what each sends:
//   Waiting      nothing: where the joints are is not known yet
//   Approaching  decoded angles, at approach_speed from where the joints were measured
//   Tracking     decoded angles, at the joints' own speed limits
//   Holding      the last goals: the camera has been silent for hold_after
//   Easing       neutral, at ease_speed: the camera has been silent for ease_after
//   Parking      neutral, at ease_speed, on request
//   Stopped      the angles measured within 50 ms before the stop came, else the last goals; torque on
//   Released     torque off
//
// Transitions, the first that applies in each call:
//   any                       -> Released     request Release
//   any but Released          -> Stopped      request Stop
//   any but those two         -> Parking      request Park, once the joints are measured
//   Stopped|Released|Parking  -> Waiting      resume(), and only then
//   Waiting                   -> Approaching  every driven joint has been measured; goals start there, without a jump
//   Approaching|Tracking      -> Holding      camera age >= hold_after
//   Holding                   -> Easing       camera age >= ease_after
//   Holding|Easing            -> Approaching  camera age < hold_after
//   Approaching               -> Tracking     every joint has caught up with its decoded angle
//   Tracking                  -> Approaching  a lost joint has come back and has not caught up
//
// In every state, the moment of a stop apart, a goal moves by at most speed * dt a call, dt being the time since the
// last call, no less than 0 and no more than max_step_ns, so that neither a clock that jumps nor a process that was
// stopped makes the head jump. A decoded angle is first cut to the joint's limits; one that is not finite holds the
// joint. A joint that starts outside its limits moves to them at the same speed. A joint whose servo has not answered
// for servo_lost_after holds its goal, and starts again from where it is measured when it answers. A joint that the
// image does not limit, and so does not drive, stays where it was first measured, and is left out of the command until
// then.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "runtime/image/load_image.h"
#include "runtime/ports/servo_command.h"

namespace tectum {

enum class GuardState : std::uint8_t { Waiting, Approaching, Tracking, Holding, Easing, Parking, Stopped, Released };
inline constexpr std::array<const char*, 8> kGuardStateNames = {"waiting", "approaching", "tracking", "holding",
                                                                "easing",  "parking",     "stopped",  "released"};

enum class GuardRequest : std::uint8_t { None, Park, Stop, Release };

struct GuardOptions {
  std::array<double, kJointCount> neutral_deg{};  // cut to the joint's limits
  double approach_speed_deg_s = 60;               // a sixth of an AX-12A's 354 deg/s: seen coming, and soon there
  double ease_speed_deg_s = 20;
  TimeNs hold_after_ns = 250'000'000;  // beyond a webcam's latency (60 to 150 ms) and two lost frames
  TimeNs ease_after_ns = 1'000'000'000;
  TimeNs servo_lost_after_ns = 500'000'000;
  TimeNs max_step_ns = 100'000'000;
};

struct GuardInput {
  TimeNs now_ns = 0;
  std::span<const double, kJointCount> decoded_deg;
  const ServoFeedback& feedback;
  TimeNs camera_age_ns = 0;
  GuardRequest request = GuardRequest::None;
};

/// Counts of what the guard changed, one for each joint and call.
struct GuardCounters {
  std::uint64_t limited = 0;      // decoded angle beyond a joint's limits
  std::uint64_t slewed = 0;       // goal behind the decoded angle for speed
  std::uint64_t not_finite = 0;   // decoded angle NaN or infinite
  std::uint64_t clock_jumps = 0;  // calls with dt < 0 or > max_step_ns
  std::uint64_t holds = 0;        // entries into Holding
  std::uint64_t losses = 0;       // joints that stopped answering
};

class ServoGuard {
 public:
  explicit ServoGuard(const SpikeImage& image, const GuardOptions& options = {});

  /// Decides this turn's command. False when there is nothing to send. Real-time safe.
  [[nodiscard]] bool decide(const GuardInput& input, ServoCommand& command) noexcept;
  /// Leaves Parking, Stopped or Released: the joints are measured anew and approached. Real-time safe.
  void resume() noexcept;

  [[nodiscard]] GuardState state() const noexcept { return state_; }
  /// Driven joints not measured since the start (Waiting) or silent for servo_lost_after. Bit j = Joint j.
  [[nodiscard]] std::uint32_t lost_mask() const noexcept;
  /// Parking has reached neutral.
  [[nodiscard]] bool is_parked() const noexcept { return state_ == GuardState::Parking && is_at_neutral_; }
  [[nodiscard]] const GuardCounters& counters() const noexcept { return counters_; }

 private:
  struct GuardedJoint {
    bool is_driven = false;
    double min_deg = 0, max_deg = 0;
    double max_speed_deg_s = 0;  // 0 = none
    double neutral_deg = 0;
    double goal_deg = 0;
    double measured_deg = 0;
    TimeNs measured_ns = 0;
    bool is_measured = false;
    bool is_lost = false;
    bool is_gentle = true;  // approaches until it has caught up
  };

  void take_feedback(const GuardInput& input) noexcept;
  void change_state(const GuardInput& input) noexcept;
  void start_from_measured(TimeNs measured_since_ns) noexcept;
  void move(const GuardInput& input, double dt_s) noexcept;
  void follow(GuardedJoint& joint, double decoded_deg, double dt_s) noexcept;
  [[nodiscard]] bool all_measured() const noexcept;

  GuardOptions options_;
  std::array<GuardedJoint, kJointCount> joints_{};
  GuardState state_ = GuardState::Waiting;
  GuardCounters counters_;
  TimeNs last_ns_ = 0;
  bool has_last_ns_ = false;
  bool is_at_neutral_ = false;
};

}  // namespace tectum
