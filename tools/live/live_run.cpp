#include "tools/live/live_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>

#include "runtime/record/recorder_thread.h"
#include "runtime/record/recording_file.h"
#include "tools/analysis/simulated_run.h"
#include "tools/live/stolen_time.h"

namespace tectum {
namespace {

constexpr TimeNs kLongestParking = 6'000'000'000;  // 90 deg at 20 deg/s, and some

class LiveLoop {
 public:
  LiveLoop(const SpikeImage& image, LiveHead& head, const LiveRunOptions& options, LiveControls& controls)
      : head_(head),
        options_(options),
        controls_(controls),
        loop_(image,
              {.left = head.eye(Eye::Left), .right = head.eye(Eye::Right), .servos = head.servos(), .clock = clock_},
              loop_options(head, options), &recorder_),
        image_(image) {
    population_begin_.reserve(image.populations.size());
    for (const PopulationRecord& population : image.populations) {
      population_begin_.push_back(population.first_neuron);
    }
  }

  LiveRun run(const std::function<void(const LiveGlimpse&)>& watch,
              const std::function<void(const LiveEvent&)>& on_event);

 private:
  static LoopOptions loop_options(LiveHead& head, const LiveRunOptions& options) {
    LoopOptions loop;
    loop.frame_period_ns = options.frame_period_ns;
    loop.one_camera_both_eyes = head.eye(Eye::Right) == nullptr;
    loop.measure_latency = true;
    loop.learns = options.learns;
    loop.engine = options.engine;
    loop.guard = options.guard;
    return loop;
  }

  [[nodiscard]] std::string start_recorder();
  void wait_for_phase();
  void loop_thread();
  void note_turn();
  void park();
  [[nodiscard]] bool is_over(TimeNs start_ns);
  void glimpse(const RecordedFrame& frame, const std::vector<RecordedSpike>& spikes);
  void tell(std::vector<LiveEvent> events, const std::function<void(const LiveEvent&)>& on_event);

  LiveHead& head_;
  const LiveRunOptions& options_;
  LiveControls& controls_;
  MonotonicClock clock_;
  RecorderThread recorder_;
  ControlLoop loop_;
  const SpikeImage& image_;
  std::vector<std::uint32_t> population_begin_;
  LiveRun result_;
  TimeNs start_ns_ = 0;
  std::atomic<bool> is_done_ = false;
  std::vector<std::string> refused_;  // by the operating system; the loop's thread writes it before is_running_
  std::atomic<bool> is_running_ = false;

  std::mutex glimpse_mutex_;
  LiveGlimpse glimpse_;
  // The loop's thread keeps these for glimpses: it takes no lock.
  std::atomic<std::uint32_t> lost_mask_ = 0;
  std::atomic<std::uint64_t> turns_ = 0, late_turns_ = 0, skipped_periods_ = 0;
};

std::string LiveLoop::start_recorder() {
  Recording run = describe_run(image_);
  describe_guard(options_.guard, run);
  run.scenario = options_.scenario;
  run.seed = options_.seed;
  run.learns = options_.learns;
  run.frame_period_ns = options_.frame_period_ns;
  run.wall_distance_m = head_.file().geometry.wall_distance_m;
  RecorderOptions recorder;
  recorder.path = options_.record_path;
  recorder.keeps = options_.keeps_recording;
  recorder.watch = [this](const RecordedFrame& frame, const std::vector<RecordedSpike>& spikes) {
    glimpse(frame, spikes);
  };
  return recorder_.start(run, recorder);
}

/// The schedule starts right behind a picture's arrival, so that pictures do not wait for most of a period.
void LiveLoop::wait_for_phase() {
  const auto newest_ns = [&] {
    TimeNs newest = 0;
    for (const Eye eye : {Eye::Left, Eye::Right}) {
      newest = head_.eye(eye) != nullptr ? std::max(newest, head_.eye(eye)->newest_at_ns()) : newest;
    }
    return newest;
  };
  const TimeNs before_ns = newest_ns();
  const TimeNs give_up_ns = clock_.now_ns() + 200'000'000;
  while (newest_ns() == before_ns && clock_.now_ns() < give_up_ns) {
    clock_.sleep_until(clock_.now_ns() + 100'000);
  }
  clock_.sleep_until(newest_ns() + options_.phase_ns);
}

bool LiveLoop::is_over(TimeNs start_ns) {
  const bool is_time_up = options_.duration_s > 0 && static_cast<double>(clock_.now_ns() - start_ns) * 1e-9 +
                                                             0.5e-9 * static_cast<double>(options_.frame_period_ns) >=
                                                         options_.duration_s;
  return is_time_up || controls_.ends || controls_.ends_at_once;
}

void LiveLoop::note_turn() {
  RecordedFrame frame = loop_.frame();
  if (head_.emulated() != nullptr) {
    add_truth(head_.emulated()->truth(), frame);
  }
  LiveFigures& figures = result_.figures;
  const TimeNs begin_ns = frame.late_ns % options_.frame_period_ns;  // behind the turn that it became
  TimeNs spent_ns = 0;
  for (std::size_t stage = 0; stage < figures.stages.size(); ++stage) {
    figures.stages[stage].add(frame.stage_ns[stage]);
    spent_ns += frame.stage_ns[stage];
  }
  figures.frame_to_command.add(spent_ns);
  figures.missed_deadlines += begin_ns + spent_ns > options_.frame_period_ns ? 1 : 0;
  figures.lateness.add(frame.late_ns);
  figures.exposure_to_turn.add(frame.time_ns - std::max(frame.captured_ns[0], frame.captured_ns[1]));
  figures.eye_skew.add(std::abs(frame.captured_ns[0] - frame.captured_ns[1]));
  lost_mask_ = loop_.guard().lost_mask();
  turns_ = loop_.counters().turns;
  late_turns_ = loop_.counters().late_turns;
  skipped_periods_ = loop_.counters().skipped_periods;
  recorder_.frame(frame);
}

void LiveLoop::loop_thread() {
  refused_ = enter_real_time(options_.real_time);
  wait_for_phase();
  const std::optional<ProcessorTicks> before = processor_ticks_now();
  start_ns_ = clock_.now_ns();
  is_running_ = true;
  while (!is_over(start_ns_)) {
    loop_.request(controls_.request);
    if (loop_.turn() == LoopStatus::Ended) {
      break;
    }
    note_turn();
  }
  result_.recording.duration_s = static_cast<double>(clock_.now_ns() - start_ns_) * 1e-9;
  result_.figures.loop = loop_.counters();
  result_.figures.missed_deadlines += loop_.counters().skipped_periods;
  if (const std::optional<ProcessorTicks> after = processor_ticks_now(); before && after) {
    result_.figures.stolen_share = stolen_share(*before, *after);
  }
  recorder_.end_turns();
  const GuardRequest request = controls_.request;
  const bool may_move = request == GuardRequest::None || request == GuardRequest::Park;  // not after a stop
  if (!controls_.ends_at_once && may_move) {
    park();
  }
  is_done_ = true;
}

/// Not part of the recording: the head goes home, slowly.
void LiveLoop::park() {
  const TimeNs end_ns = clock_.now_ns() + kLongestParking;
  loop_.request(GuardRequest::Park);
  while (!loop_.guard().is_parked() && clock_.now_ns() < end_ns && !controls_.ends_at_once) {
    if (loop_.turn() == LoopStatus::Ended) {
      return;
    }
  }
  result_.is_parked = loop_.guard().is_parked();
}

void LiveLoop::glimpse(const RecordedFrame& frame, const std::vector<RecordedSpike>& spikes) {
  const std::lock_guard lock(glimpse_mutex_);
  glimpse_.time_s = static_cast<double>(frame.time_ns - start_ns_) * 1e-9;
  glimpse_.state = static_cast<GuardState>(frame.guard_state);
  glimpse_.frame = frame;
  glimpse_.lost_mask = lost_mask_;
  glimpse_.counters.turns = turns_;
  glimpse_.counters.late_turns = late_turns_;
  glimpse_.counters.skipped_periods = skipped_periods_;
  glimpse_.spikes_of_population.resize(population_begin_.size());
  for (const RecordedSpike& spike : spikes) {
    for (std::size_t p = 0; p < population_begin_.size(); ++p) {
      if (spike.neuron - population_begin_[p] < image_.populations[p].size) {
        ++glimpse_.spikes_of_population[p];
      }
    }
  }
}

void LiveLoop::tell(std::vector<LiveEvent> events, const std::function<void(const LiveEvent&)>& on_event) {
  for (LiveEvent& event : events) {
    if (on_event) {
      on_event(event);
    }
    result_.events.push_back(std::move(event));
  }
}

LiveRun LiveLoop::run(const std::function<void(const LiveGlimpse&)>& watch,
                      const std::function<void(const LiveEvent&)>& on_event) {
  result_.error = head_.wait_until_ready(options_.ready_within_ns);
  if (result_.error.empty()) {
    result_.error = start_recorder();
  }
  if (!result_.error.empty()) {
    tell(head_.take_events(), on_event);
    return std::move(result_);
  }
  std::thread thread([this] { loop_thread(); });
  GuardState state = GuardState::Waiting;
  bool has_told_refusals = false;
  while (!is_done_) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (is_running_ && !has_told_refusals) {
      has_told_refusals = true;
      for (const std::string& line : refused_) {
        tell({{start_ns_, line}}, on_event);
      }
    }
    LiveGlimpse seen;
    {
      const std::lock_guard lock(glimpse_mutex_);
      seen = glimpse_;
      std::fill(glimpse_.spikes_of_population.begin(), glimpse_.spikes_of_population.end(), 0U);
    }
    tell(head_.take_events(), on_event);
    if (seen.state != state && seen.frame.time_ns != 0) {
      state = seen.state;
      tell({{seen.frame.time_ns, std::string("guard: ") + kGuardStateNames[static_cast<std::size_t>(state)]}},
           on_event);
    }
    if (watch && is_running_) {
      watch(seen);
    }
  }
  thread.join();
  head_.servos().stop();  // torque off
  tell(head_.take_events(), on_event);
  const double duration_s = result_.recording.duration_s;
  const std::string record_error = recorder_.finish(duration_s);
  result_.error = record_error;
  result_.recording = std::move(recorder_.recording());
  result_.recording.duration_s = duration_s;
  if (loop_.learner() != nullptr) {
    result_.learned_scales.assign(loop_.learner()->scales().begin(), loop_.learner()->scales().end());
  }
  result_.figures.guard = loop_.guard().counters();
  result_.figures.head = head_.servos().report();
  result_.figures.frame_to_last_byte = head_.servos().issue_latency();
  result_.figures.lost_frames = recorder_.lost_frames();
  result_.figures.lost_spikes = recorder_.lost_spikes();
  for (LiveEvent& event : result_.events) {
    event.at_ns -= start_ns_;
  }
  return std::move(result_);
}

}  // namespace

LiveRun run_live(const SpikeImage& image, LiveHead& head, const LiveRunOptions& options, LiveControls& controls,
                 const std::function<void(const LiveGlimpse&)>& watch,
                 const std::function<void(const LiveEvent&)>& on_event) {
  LiveLoop loop(image, head, options, controls);
  return loop.run(watch, on_event);
}

}  // namespace tectum
