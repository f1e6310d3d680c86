// The whole simulated head: six servos, two cameras, the dot on the wall and the time they share.
//
// Time is virtual and moves only in sleep_until(), which runs the servos and takes the exposures that fall due. The
// same parameters and the same commands give the same frames, byte for byte.
#pragma once

#include <cstdint>
#include <memory>

#include "drivers/head/ax12_plant.h"
#include "drivers/head/eye_camera.h"
#include "drivers/head/geometry.h"
#include "drivers/head/scenario.h"
#include "runtime/ports/camera.h"
#include "runtime/ports/clock.h"
#include "runtime/ports/servo_bus.h"

namespace tectum {

struct SimHeadParams {
  std::uint64_t seed = 1;  // of servos, scenario and noise; overrides theirs
  HeadGeometry geometry;   // overrides the scenario's wall distance
  Ax12Params servo;
  EyeCameraParams camera;
  ScenarioParams scenario;
  TimeNs frame_period_ns = 22'222'222;  // 45 Hz, the published loop. Exposure k is taken at k * frame_period_ns
  std::uint32_t camera_latency_frames =
      1;                     // exposure k can be read from (k + latency) * frame_period_ns on; at most 15
  double dropped_share = 0;  // of the frames, each at random: neither eye's can ever be read
  JointAngles start_deg{};
};

/// What is true at one moment; the fields are those of EyeTruth in runtime/record/recording.h.
struct EyeGaze {
  double target_pan_deg = 0;  // target's direction seen from the eye, head-base frame
  double target_tilt_deg = 0;
  double error_pan_deg = 0;  // positive: the target is to the right of the optical axis
  double error_tilt_deg = 0;
  double gaze_pan_deg = 0;  // optical axis, head-base frame
  double gaze_tilt_deg = 0;
  WallPoint gaze_on_wall_m{};
};

struct HeadTruth {
  TimeNs time_ns = 0;
  JointAngles joint_deg{};       // the shafts, not what the servos report
  WallPoint target_on_wall_m{};  // on the dot's own plane, where a path carries it before the wall
  std::array<EyeGaze, kEyeCount> eye{};
};

/// All that a picture depends on, taken at one moment and drawn later.
struct HeadExposure {
  std::uint64_t sequence = 0;
  JointAngles joint_deg{};
  WallPoint target_m{};
  double target_distance_m = 0;  // of the plane that target_m is on
};

class SimHead final : public ServoBus, public Clock {
 public:
  explicit SimHead(const SimHeadParams& params);
  ~SimHead() override;

  // ServoBus. A command starts its way at the present virtual time.
  [[nodiscard]] bool write(const ServoCommand& command) noexcept override;
  void read(TimeNs now_ns, ServoFeedback& out) noexcept override;

  // Clock.
  [[nodiscard]] TimeNs now_ns() noexcept override;
  void sleep_until(TimeNs when_ns) noexcept override;

  /// Belongs to the head. Draws the newest exposure that is ready when read; a frame that is never read is never drawn.
  [[nodiscard]] Camera& eye_camera(Eye eye) noexcept;

  /// The same in two steps, for a head that threads share: the first touches what time moves, the second only the
  /// eye's own picture, which stays until it is drawn again. An eye is read in one of the two ways.
  [[nodiscard]] CameraStatus take_exposure(Eye eye, TimeNs now_ns, HeadExposure& out) noexcept;
  void draw(Eye eye, const HeadExposure& exposure, Frame& out) noexcept;

  [[nodiscard]] HeadTruth truth_at_now();
  [[nodiscard]] const SimHeadParams& params() const noexcept;
  [[nodiscard]] double servo_dead_time_s(Joint joint) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
