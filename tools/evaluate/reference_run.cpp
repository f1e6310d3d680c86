#include "tools/evaluate/reference_run.h"

#include <algorithm>
#include <cmath>

#include "runtime/act/servo_guard.h"
#include "runtime/record/recording_file.h"
#include "tools/evaluate/dot_finder.h"

namespace tectum {
namespace {

constexpr std::array<std::array<Joint, 2>, kEyeCount> kEyeJoints = {
    {{Joint::LeftEyePan, Joint::LeftEyeTilt}, {Joint::RightEyePan, Joint::RightEyeTilt}}};

/// One joint by its own retinal error. The integral stops at the joint's mechanical limits.
class PidLoop {
 public:
  PidLoop(const PidGains& gains, JointLimits limits) : gains_(gains), limits_(limits) {}

  [[nodiscard]] double goal_deg(double error_deg, double dt_s) {
    integral_deg_ = std::clamp(integral_deg_ + gains_.i_hz * error_deg * dt_s, limits_.min_deg, limits_.max_deg);
    const double slope_deg_s = has_last_ && dt_s > 0 ? (error_deg - last_deg_) / dt_s : 0;
    last_deg_ = error_deg;
    has_last_ = true;
    return integral_deg_ + gains_.p * error_deg + gains_.d_s * slope_deg_s;
  }
  /// A target that comes back into view has no rate yet.
  void lose_target() { has_last_ = false; }

 private:
  PidGains gains_;
  JointLimits limits_;
  double integral_deg_ = 0;
  double last_deg_ = 0;
  bool has_last_ = false;
};

/// What an eye has of the dot: where it is off the axis, if it is seen at all.
struct SeenDot {
  Direction error;
  bool is_seen = false;
};

class Reference {
 public:
  Reference(const SimHeadParams& params, const ReferenceController& controller)
      : params_(params), controller_(controller) {
    for (std::size_t j = 0; j < kJointCount; ++j) {
      loops_.emplace_back(controller.pid, params.geometry.limits[j]);
    }
  }

  void see(const std::array<HeadExposure, kEyeCount>& exposures, JointAngles& goal_deg) {
    std::array<SeenDot, kEyeCount> dots{};
    for (const Eye eye : {Eye::Left, Eye::Right}) {
      const HeadExposure& exposure = exposures[index_of(eye)];
      const auto& joints = kEyeJoints[index_of(eye)];
      if (controller_.kind == ReferenceKind::Oracle) {
        HeadGeometry with_plane = params_.geometry;
        with_plane.wall_distance_m = exposure.target_distance_m;
        const Direction wanted = eye_angles_towards(with_plane, 0, 0, eye, exposure.target_m);
        goal_deg[index_of(joints[0])] = wanted.pan_deg;
        goal_deg[index_of(joints[1])] = wanted.tilt_deg;
      }
      const EyePose pose = eye_pose(params_.geometry, exposure.joint_deg, eye);
      const Direction error =
          error_in_eye(pose, {exposure.target_m[0], exposure.target_m[1], exposure.target_distance_m});
      const double half_view_deg = params_.camera.field_of_view_deg / 2;
      dots[index_of(eye)] = {error,
                             std::abs(error.pan_deg) < half_view_deg && std::abs(error.tilt_deg) < half_view_deg};
    }
    if (controller_.kind == ReferenceKind::Pid) {
      servo(dots, goal_deg);
    }
  }

  /// An eye that does not see the target goes by the error of the one that does; when neither does, both hold.
  void servo(const std::array<SeenDot, kEyeCount>& dots, JointAngles& goal_deg) {
    const double dt_s = static_cast<double>(params_.frame_period_ns) * 1e-9;
    for (std::size_t e = 0; e < kEyeCount; ++e) {
      const SeenDot& dot = dots[dots[e].is_seen ? e : 1 - e];
      for (const auto& [joint, error_deg] :
           {std::pair{kEyeJoints[e][0], dot.error.pan_deg}, std::pair{kEyeJoints[e][1], dot.error.tilt_deg}}) {
        if (dot.is_seen) {
          goal_deg[index_of(joint)] = loops_[index_of(joint)].goal_deg(error_deg, dt_s);
        } else {
          loops_[index_of(joint)].lose_target();
        }
      }
    }
  }

 private:
  const SimHeadParams& params_;
  ReferenceController controller_;
  std::vector<PidLoop> loops_;
};

std::array<SeenDot, kEyeCount> seen_dots(SimHead& head, const std::array<HeadExposure, kEyeCount>& exposures,
                                         DotFinder& finder) {
  std::array<SeenDot, kEyeCount> dots{};
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    Frame frame;
    head.draw(eye, exposures[index_of(eye)], frame);
    const std::optional<Direction> found = finder.find(frame);
    dots[index_of(eye)] = {found.value_or(Direction{}), found.has_value()};
  }
  return dots;
}

RecordedFrame frame_at(TimeNs now_ns, const ServoFeedback& feedback, const JointAngles& wanted_deg) {
  RecordedFrame frame;
  frame.time_ns = now_ns;
  frame.position_deg = feedback.position_deg;
  frame.fresh_mask = feedback.fresh_mask;
  frame.decoded_deg = wanted_deg;
  return frame;
}

}  // namespace

Recording run_reference(const SpikeImage& image, const SimulatedRunOptions& options,
                        const ReferenceController& controller) {
  SimHead head(options.head);
  ServoGuard guard(image);
  Reference reference(head.params(), controller);
  DotFinder finder(image, head.params().camera.field_of_view_deg);
  Recording recording = describe_run(image);
  recording.scenario = scenario_name(options.head.scenario.kind);
  recording.seed = options.head.seed;
  recording.frame_period_ns = options.head.frame_period_ns;
  recording.duration_s = options.duration_s;
  recording.wall_distance_m = options.head.geometry.wall_distance_m;

  const TimeNs period_ns = options.head.frame_period_ns;
  const auto duration_ns = static_cast<TimeNs>(std::llround(options.duration_s * 1e9));
  const TimeNs turns = std::max<TimeNs>(1, (duration_ns + period_ns - 1) / period_ns);
  JointAngles goal_deg = options.head.start_deg;
  TimeNs captured_ns = 0;
  ServoFeedback feedback;
  ServoCommand command;
  for (TimeNs turn = 0; turn < turns; ++turn) {
    head.sleep_until(turn * period_ns);
    const TimeNs now_ns = head.now_ns();
    std::array<HeadExposure, kEyeCount> exposures;  // both eyes' shutters open at once
    if (head.take_exposure(Eye::Left, now_ns, exposures[0]) == CameraStatus::NewFrame &&
        head.take_exposure(Eye::Right, now_ns, exposures[1]) == CameraStatus::NewFrame) {
      captured_ns = static_cast<TimeNs>(exposures[0].sequence) * period_ns;
      if (controller.kind == ReferenceKind::PidFromPicture) {
        reference.servo(seen_dots(head, exposures, finder), goal_deg);
      } else {
        reference.see(exposures, goal_deg);
      }
    }
    head.read(now_ns, feedback);
    RecordedFrame frame = frame_at(now_ns, feedback, goal_deg);
    frame.camera_age_ns = now_ns - captured_ns;
    frame.has_command = guard.decide({.now_ns = now_ns,
                                      .decoded_deg = goal_deg,
                                      .feedback = feedback,
                                      .camera_age_ns = frame.camera_age_ns,
                                      .request = GuardRequest::None},
                                     command);
    frame.goal_deg = frame.has_command ? command.goal_deg : feedback.position_deg;
    if (frame.has_command) {
      (void)head.write(command);  // a simulated bus takes everything
    }
    add_truth(head.truth_at_now(), frame);
    recording.frames.push_back(std::move(frame));
  }
  return recording;
}

}  // namespace tectum
