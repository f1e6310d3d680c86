#include "tools/analysis/simulated_run.h"

#include <cmath>
#include <vector>

#include "tools/analysis/run_recorder.h"

namespace tectum {
namespace {

/// Passes the head's frames on and remembers the last one, for those who want to see the pictures.
class WatchedCamera final : public Camera {
 public:
  explicit WatchedCamera(Camera& camera) : camera_(camera) {}
  [[nodiscard]] CameraStatus read(TimeNs now_ns, Frame& out) noexcept override {
    const CameraStatus status = camera_.read(now_ns, out);
    if (status == CameraStatus::NewFrame) {
      last_ = out;
    }
    return status;
  }
  [[nodiscard]] const Frame& last() const { return last_; }

 private:
  Camera& camera_;
  Frame last_;
};

/// Passes the head's time on in steps, and notes where the shafts are after each. A frame every 22 ms is too rare for
/// the speed of a saccade.
class SamplingClock final : public Clock {
 public:
  SamplingClock(SimHead& head, double rate_hz, std::vector<RecordedPositions>& samples)
      : head_(head), samples_(samples), rate_hz_(rate_hz) {}
  [[nodiscard]] TimeNs now_ns() noexcept override { return head_.now_ns(); }
  void sleep_until(TimeNs when_ns) noexcept override {
    while (rate_hz_ > 0 && next_ns() <= when_ns) {
      head_.sleep_until(next_ns());
      samples_.push_back({head_.now_ns(), head_.truth_at_now().joint_deg});
      ++count_;
    }
    head_.sleep_until(when_ns);
  }

 private:
  [[nodiscard]] TimeNs next_ns() const { return std::llround(static_cast<double>(count_) * 1e9 / rate_hz_); }
  SimHead& head_;
  std::vector<RecordedPositions>& samples_;
  double rate_hz_;
  std::uint64_t count_ = 0;
};

DotColour colour_for(LitChannel channel) {
  switch (channel) {
    case LitChannel::Green:
    case LitChannel::GreenOverRedBlue:
      return DotColour::Green;
    case LitChannel::Blue:
    case LitChannel::BlueOverRedGreen:
      return DotColour::Blue;
    default:
      return DotColour::Red;
  }
}

}  // namespace

SimHeadParams fitted_to(const SpikeImage& image, SimHeadParams head) {
  if (!image.retinas.empty()) {
    head.camera.field_of_view_deg = image.retinas.front().field_of_view_deg;
    head.camera.dot_colour = colour_for(image.retinas.front().lit_channel);
  }
  return head;
}

void add_truth(const HeadTruth& truth, RecordedFrame& frame) {
  frame.has_truth = true;
  frame.target_on_wall_m = truth.target_on_wall_m;
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    const EyeGaze& gaze = truth.eye[eye];
    frame.eye[eye] = {.target_pan_deg = gaze.target_pan_deg,
                      .target_tilt_deg = gaze.target_tilt_deg,
                      .error_pan_deg = gaze.error_pan_deg,
                      .error_tilt_deg = gaze.error_tilt_deg,
                      .gaze_pan_deg = gaze.gaze_pan_deg,
                      .gaze_tilt_deg = gaze.gaze_tilt_deg,
                      .gaze_on_wall_m = gaze.gaze_on_wall_m};
  }
}

Recording run_simulated_head(const SpikeImage& image, const SimulatedRunOptions& options, const RunObserver& observer) {
  SimHead head(options.head);
  WatchedCamera left(head.eye_camera(Eye::Left));
  WatchedCamera right(head.eye_camera(Eye::Right));
  RunRecorder recorder(image);
  if (options.keeps_spikes) {
    recorder.expect(options.duration_s);
  }
  LoopOptions loop_options;
  loop_options.frame_period_ns = options.head.frame_period_ns;
  loop_options.engine = options.engine;
  loop_options.learns = options.learns;
  SamplingClock clock(head, options.sample_rate_hz, recorder.recording().positions);
  ControlLoop loop(image, {.left = &left, .right = &right, .servos = head, .clock = clock}, loop_options,
                   options.keeps_spikes ? &recorder : nullptr);

  const auto duration_ns = static_cast<TimeNs>(std::llround(options.duration_s * 1e9));
  const auto turns = static_cast<std::uint64_t>(
      std::max<TimeNs>(1, (duration_ns + options.head.frame_period_ns - 1) / options.head.frame_period_ns));
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    if (loop.turn() == LoopStatus::Ended) {
      break;
    }
    RecordedFrame frame = loop.frame();
    add_truth(head.truth_at_now(), frame);
    recorder.add_frame(std::move(frame));
    if (observer.pictures && left.last().bgr != nullptr && right.last().bgr != nullptr) {
      observer.pictures(left.last(), right.last());
    }
    if (observer.progress) {
      observer.progress(static_cast<double>(turn + 1) / static_cast<double>(turns));
    }
  }

  if (observer.learned && loop.learner() != nullptr) {
    observer.learned(loop.learner()->scales());
  }

  Recording& recording = recorder.recording();
  recording.learns = options.learns;
  recording.scenario = scenario_name(options.head.scenario.kind);
  recording.seed = options.head.seed;
  recording.frame_period_ns = options.head.frame_period_ns;
  recording.duration_s = options.duration_s;
  recording.wall_distance_m = options.head.geometry.wall_distance_m;
  return std::move(recording);
}

}  // namespace tectum
