#include "drivers/head/sim_head.h"

#include <algorithm>
#include <array>
#include <vector>

#include "drivers/head/random_streams.h"

namespace tectum {
namespace {

constexpr std::uint32_t kMostLatencyFrames = 15;
constexpr std::uint32_t kKept = kMostLatencyFrames + 1;

SimHeadParams with_shared_settings(SimHeadParams params) {
  params.camera.seed = params.seed;
  params.scenario.seed = params.seed;
  params.scenario.wall_distance_m = params.geometry.wall_distance_m;
  params.camera_latency_frames = std::min(params.camera_latency_frames, kMostLatencyFrames);
  params.frame_period_ns = std::max<TimeNs>(params.frame_period_ns, 100'000);
  return params;
}

}  // namespace

struct SimHead::Impl {
  explicit Impl(const SimHeadParams& given);

  class View final : public Camera {
   public:
    View(Impl& world, Eye eye, std::shared_ptr<const ClutteredWall> wall)
        : world_(world),
          eye_(eye),
          renderer_(world.params.camera, world.params.geometry, static_cast<std::uint32_t>(eye), std::move(wall)) {}

    CameraStatus read(TimeNs now_ns, Frame& out) noexcept override {
      HeadExposure exposure;
      const CameraStatus status = take(now_ns, exposure);
      if (status == CameraStatus::NewFrame) {
        draw(exposure, out);
      }
      return status;
    }

    CameraStatus take(TimeNs now_ns, HeadExposure& out) noexcept {
      const TimeNs period_ns = world_.params.frame_period_ns;
      const std::int64_t newest =
          std::min(now_ns, world_.now_ns) / period_ns - static_cast<std::int64_t>(world_.params.camera_latency_frames);
      if (newest <= last_) {
        return CameraStatus::NoNewFrame;
      }
      last_ = newest;
      if (world_.is_dropped(newest)) {
        return CameraStatus::NoNewFrame;
      }
      out = world_.exposures[static_cast<std::size_t>(newest) % kKept];
      return CameraStatus::NewFrame;
    }

    void draw(const HeadExposure& exposure, Frame& out) noexcept {
      const EyePose pose = eye_pose(world_.params.geometry, exposure.joint_deg, eye_);
      const cv::Mat& picture = renderer_.render_in_depth(
          pose, {exposure.target_m[0], exposure.target_m[1], exposure.target_distance_m}, exposure.sequence);
      const TimeNs captured_ns = static_cast<TimeNs>(exposure.sequence) * world_.params.frame_period_ns;
      out = {picture.data, picture.cols, picture.rows, picture.step, captured_ns, exposure.sequence};
    }

   private:
    Impl& world_;
    Eye eye_;
    EyeCamera renderer_;
    std::int64_t last_ = -1;
  };

  [[nodiscard]] bool is_dropped(std::int64_t frame) const {
    const auto index = static_cast<std::uint64_t>(frame);
    return params.dropped_share > 0 &&
           head::unit_interval(head::draw(params.seed, head::Stream::DroppedFrames, index)[0]) < params.dropped_share;
  }

  [[nodiscard]] JointAngles joints(TimeNs at_ns) const {
    JointAngles joint_deg{};
    for (std::size_t j = 0; j < kJointCount; ++j) {
      joint_deg[j] = servos[j].position_deg(at_ns);
    }
    return joint_deg;
  }

  void advance_servos(TimeNs to_ns) {
    for (Ax12Plant& servo : servos) {
      servo.advance_to(to_ns);
    }
  }

  void expose() {
    const TimeNs at_ns = static_cast<TimeNs>(next_exposure) * params.frame_period_ns;
    advance_servos(at_ns);
    exposures[next_exposure % kKept] = {next_exposure, joints(at_ns), scenario.target_m(at_ns),
                                        scenario.target_distance_m(at_ns)};
    ++next_exposure;
  }

  SimHeadParams params;
  Scenario scenario;
  std::vector<Ax12Plant> servos;
  TimeNs now_ns = 0;
  std::uint64_t next_exposure = 0;
  std::array<HeadExposure, kKept> exposures{};
  std::array<std::unique_ptr<View>, kEyeCount> views;
};

SimHead::Impl::Impl(const SimHeadParams& given) : params(with_shared_settings(given)), scenario(params.scenario) {
  for (std::uint32_t j = 0; j < kJointCount; ++j) {
    servos.emplace_back(params.servo, params.geometry.limits[j], params.seed, j, params.start_deg[j]);
  }
  const auto wall = params.camera.clutter ? make_cluttered_wall(params.camera) : nullptr;
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    views[index_of(eye)] = std::make_unique<View>(*this, eye, wall);
  }
  expose();
}

SimHead::SimHead(const SimHeadParams& params) : impl_(std::make_unique<Impl>(params)) {}
SimHead::~SimHead() = default;

bool SimHead::write(const ServoCommand& command) noexcept {
  for (std::size_t j = 0; j < kJointCount; ++j) {
    impl_->servos[j].command(impl_->now_ns, command.goal_deg[j], command.torque_on);
  }
  return true;
}

void SimHead::read(TimeNs /*now_ns*/, ServoFeedback& out) noexcept {
  out.measured_ns = impl_->now_ns;
  out.fresh_mask = (1U << kJointCount) - 1U;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    out.position_deg[j] = impl_->servos[j].measured_deg(impl_->now_ns);
  }
}

TimeNs SimHead::now_ns() noexcept { return impl_->now_ns; }

void SimHead::sleep_until(TimeNs when_ns) noexcept {
  while (static_cast<TimeNs>(impl_->next_exposure) * impl_->params.frame_period_ns <= when_ns) {
    impl_->expose();
  }
  impl_->now_ns = std::max(impl_->now_ns, when_ns);
  impl_->advance_servos(impl_->now_ns);
}

Camera& SimHead::eye_camera(Eye eye) noexcept { return *impl_->views[index_of(eye)]; }

CameraStatus SimHead::take_exposure(Eye eye, TimeNs now_ns, HeadExposure& out) noexcept {
  return impl_->views[index_of(eye)]->take(now_ns, out);
}

void SimHead::draw(Eye eye, const HeadExposure& exposure, Frame& out) noexcept {
  impl_->views[index_of(eye)]->draw(exposure, out);
}

HeadTruth SimHead::truth_at_now() {
  const HeadGeometry& geometry = impl_->params.geometry;
  HeadTruth truth;
  truth.time_ns = impl_->now_ns;
  truth.joint_deg = impl_->joints(truth.time_ns);
  truth.target_on_wall_m = impl_->scenario.target_m(truth.time_ns);
  const Eigen::Vector3d target_m = {truth.target_on_wall_m[0], truth.target_on_wall_m[1],
                                    impl_->scenario.target_distance_m(truth.time_ns)};
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    const EyePose pose = eye_pose(geometry, truth.joint_deg, eye);
    const Direction target = direction_from_eye(pose, target_m);
    const Direction error = error_in_eye(pose, target_m);
    const Direction gaze = gaze_direction(pose);
    truth.eye[index_of(eye)] = {target.pan_deg,
                                target.tilt_deg,
                                error.pan_deg,
                                error.tilt_deg,
                                gaze.pan_deg,
                                gaze.tilt_deg,
                                gaze_on_wall(geometry, pose)};
  }
  return truth;
}

const SimHeadParams& SimHead::params() const noexcept { return impl_->params; }

double SimHead::servo_dead_time_s(Joint joint) const noexcept { return impl_->servos[index_of(joint)].dead_time_s(); }

}  // namespace tectum
