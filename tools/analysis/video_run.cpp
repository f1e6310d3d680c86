#include "tools/analysis/video_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "drivers/camera/video_camera.h"
#include "runtime/loop/echo_servo_bus.h"
#include "tools/analysis/run_recorder.h"

namespace tectum {
namespace {

class VirtualClock final : public Clock {
 public:
  [[nodiscard]] TimeNs now_ns() noexcept override { return now_ns_; }
  void sleep_until(TimeNs when_ns) noexcept override { now_ns_ = std::max(now_ns_, when_ns); }

 private:
  TimeNs now_ns_ = 0;
};

std::string joined(const std::vector<std::string>& files) {
  std::string text = "video";
  for (const std::string& file : files) {
    const std::size_t slash = file.find_last_of('/');
    text += " " + (slash == std::string::npos ? file : file.substr(slash + 1));
  }
  return text;
}

}  // namespace

VideoRun run_on_video(const SpikeImage& image, const VideoRunOptions& options, const RunObserver& observer) {
  VideoRun run;
  std::vector<std::unique_ptr<VideoSource>> sources;
  for (const std::string& file : options.files) {
    sources.push_back(VideoSource::open(file, run.error, options.frame_rate_hz));
    if (sources.back() == nullptr) {
      return run;
    }
  }
  const double rate_hz = options.frame_rate_hz > 0 ? options.frame_rate_hz : sources.front()->fps();
  EchoServoBus servos;
  VirtualClock clock;
  RunRecorder recorder(image);
  LoopOptions loop_options;
  loop_options.frame_period_ns = static_cast<TimeNs>(std::llround(1e9 / rate_hz));
  loop_options.engine = options.engine;
  loop_options.learns = options.learns;
  ControlLoop loop(image,
                   {.left = &sources.front()->view(Eye::Left),
                    .right = &sources.back()->view(Eye::Right),
                    .servos = servos,
                    .clock = clock},
                   loop_options, &recorder);

  const auto end_ns = static_cast<TimeNs>(std::llround(options.duration_s * 1e9));
  const auto expected = static_cast<double>(sources.front()->frame_count());
  while (options.duration_s <= 0 || clock.now_ns() < end_ns) {
    if (loop.turn() == LoopStatus::Ended) {
      break;
    }
    recorder.add_frame(loop.frame());
    if (observer.progress && expected > 0) {
      observer.progress(static_cast<double>(loop.counters().turns) / expected);
    }
  }

  if (observer.learned && loop.learner() != nullptr) {
    observer.learned(loop.learner()->scales());
  }
  Recording& recording = recorder.recording();
  recording.learns = options.learns;
  recording.scenario = joined(options.files);
  recording.frame_period_ns = loop_options.frame_period_ns;
  recording.duration_s =
      static_cast<double>(loop.counters().turns) * 1e-9 * static_cast<double>(loop_options.frame_period_ns);
  run.recording = std::move(recording);
  return run;
}

}  // namespace tectum
