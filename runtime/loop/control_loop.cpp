#include "runtime/loop/control_loop.h"

#include <algorithm>
#include <chrono>
#include <limits>

namespace tectum {
namespace {

/// Adds the time from one lap to the next; all zeros when it is off.
class Stopwatch {
 public:
  explicit Stopwatch(bool is_on) noexcept : is_on_(is_on), last_(now()) {}
  [[nodiscard]] TimeNs lap_ns() noexcept {
    const auto then = last_;
    last_ = now();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(last_ - then).count();
  }

 private:
  using Steady = std::chrono::steady_clock;
  [[nodiscard]] Steady::time_point now() const noexcept { return is_on_ ? Steady::now() : Steady::time_point{}; }
  bool is_on_;
  Steady::time_point last_;
};

}  // namespace

ControlLoop::ControlLoop(const SpikeImage& image, const LoopPorts& ports, const LoopOptions& options, SpikeSink* sink)
    : ports_(ports),
      options_(options),
      sink_(sink),
      tick_ns_(static_cast<TimeNs>(image.header.tick_ns)),
      engine_(image, options.engine),
      learner_(options.learns ? std::make_optional<Learner>(image) : std::nullopt),
      reward_(image),
      decoder_(image),
      guard_(image, options.guard) {
  std::array<std::uint32_t, kEyeCount> field_count{};
  for (std::uint32_t r = 0; r < image.retinas.size(); ++r) {
    const RetinaRecord& record = image.retinas[r];
    std::uint32_t& fields_of_eye = field_count[static_cast<std::size_t>(record.eye)];
    sheets_.push_back({record.eye, Retina(image, r), record.first_neuron, fields_of_eye, {}});
    sheets_.back().was_active.reserve(record.field_count);
    fields_of_eye += record.field_count;
  }
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    frame_.active_fields[e].reserve(field_count[e]);
  }
  eyes_[0].camera = ports.left;
  const bool is_shared = ports.right == ports.left || (ports.right == nullptr && options.one_camera_both_eyes);
  eyes_[1].camera = is_shared ? ports.left : ports.right;
}

LoopStatus ControlLoop::turn() noexcept {
  const TimeNs now_ns = wait_for_turn();
  Stopwatch stopwatch(options_.measure_latency);
  if (read(now_ns) == LoopStatus::Ended) {
    return LoopStatus::Ended;
  }
  stage_times_.read_ns = stopwatch.lap_ns();
  encode(now_ns);
  stage_times_.encode_ns = stopwatch.lap_ns();
  learn();
  step();
  stage_times_.step_ns = stopwatch.lap_ns();
  decode(now_ns);
  stage_times_.decode_ns = stopwatch.lap_ns();
  write();
  stage_times_.write_ns = stopwatch.lap_ns();
  frame_.stage_ns = {stage_times_.read_ns, stage_times_.encode_ns, stage_times_.step_ns, stage_times_.decode_ns,
                     stage_times_.write_ns};
  ++counters_.turns;
  return LoopStatus::Running;
}

void ControlLoop::resume() noexcept {
  request(GuardRequest::None);
  guard_.resume();
}

TimeNs ControlLoop::wait_for_turn() noexcept {
  if (!has_started_) {
    has_started_ = true;
    due_ns_ = ports_.clock.now_ns();
    for (EyeState& eye : eyes_) {
      eye.fresh_ns = due_ns_;
    }
  } else {
    due_ns_ += options_.frame_period_ns;
  }
  ports_.clock.sleep_until(due_ns_);
  const TimeNs now_ns = ports_.clock.now_ns();
  frame_.late_ns = now_ns - due_ns_;
  const TimeNs missed = frame_.late_ns / options_.frame_period_ns;
  if (missed > 0) {
    ++counters_.late_turns;
    counters_.skipped_periods += static_cast<std::uint64_t>(missed);
    due_ns_ += missed * options_.frame_period_ns;
  }
  return now_ns;
}

LoopStatus ControlLoop::read(TimeNs now_ns) noexcept {
  const bool is_shared = eyes_[1].camera == eyes_[0].camera;
  bool has_ended = read_eye(eyes_[0], 0, now_ns) == CameraStatus::Ended;
  if (is_shared) {
    eyes_[1] = eyes_[0];
    counters_.frames[1] = counters_.frames[0];
    counters_.failed_reads[1] = counters_.failed_reads[0];
  } else {
    has_ended = read_eye(eyes_[1], 1, now_ns) == CameraStatus::Ended || has_ended;
  }
  ports_.servos.read(now_ns, feedback_);
  return has_ended ? LoopStatus::Ended : LoopStatus::Running;
}

CameraStatus ControlLoop::read_eye(EyeState& eye, std::size_t index, TimeNs now_ns) noexcept {
  eye.has_new_frame = false;
  if (eye.camera == nullptr) {
    return CameraStatus::NoNewFrame;
  }
  const CameraStatus status = eye.camera->read(now_ns, eye.frame);
  eye.has_new_frame = status == CameraStatus::NewFrame;
  counters_.frames[index] += eye.has_new_frame ? 1 : 0;
  counters_.failed_reads[index] += status == CameraStatus::Failed ? 1 : 0;
  return status;
}

void ControlLoop::encode(TimeNs now_ns) noexcept {
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    EyeState& eye = eyes_[e];
    if (eye.has_new_frame && !eye.has_size) {
      prepare_eye(e);
    }
    bool is_seen = eye.has_new_frame;
    for (Sheet& sheet : sheets_) {
      if (eye.has_new_frame && static_cast<std::size_t>(sheet.eye) == e) {
        is_seen = sheet.retina.encode(eye.frame) && is_seen;
      }
    }
    if (is_seen) {
      eye.fresh_ns = std::min(eye.frame.captured_ns, now_ns);
      frame_.captured_ns[e] = eye.frame.captured_ns;
    }
    counters_.refused_frames[e] += eye.has_new_frame && !is_seen ? 1 : 0;
    eye.is_stale = now_ns - eye.fresh_ns >= options_.guard.hold_after_ns;
    frame_.active_fields[e].clear();
  }
  for (Sheet& sheet : sheets_) {
    const auto e = static_cast<std::size_t>(sheet.eye);
    drive(sheet, eyes_[e].is_stale ? std::span<const std::uint32_t>{} : sheet.retina.active());
    for (const std::uint32_t field : sheet.was_active) {
      frame_.active_fields[e].push_back(sheet.first_recorded + field);  // within the reserved capacity
    }
  }
}

void ControlLoop::prepare_eye(std::size_t eye_index) noexcept {
  EyeState& eye = eyes_[eye_index];
  eye.has_size = true;
  for (Sheet& sheet : sheets_) {
    if (static_cast<std::size_t>(sheet.eye) == eye_index) {
      eye.has_size = sheet.retina.prepare(eye.frame.width_px, eye.frame.height_px) && eye.has_size;
    }
  }
}

/// Tells the engine what changed between two ascending lists.
void ControlLoop::drive(Sheet& sheet, std::span<const std::uint32_t> active) noexcept {
  auto before = sheet.was_active.begin();
  auto after = active.begin();
  while (before != sheet.was_active.end() || after != active.end()) {
    const bool is_off = after == active.end() || (before != sheet.was_active.end() && *before < *after);
    const bool is_on = before == sheet.was_active.end() || (after != active.end() && *after < *before);
    if (is_off) {
      engine_.set_field_active(NeuronId{sheet.first_neuron + *before++}, false);
    } else if (is_on) {
      engine_.set_field_active(NeuronId{sheet.first_neuron + *after++}, true);
    } else {
      ++before;
      ++after;
    }
  }
  sheet.was_active.assign(active.begin(), active.end());
}

void ControlLoop::learn() noexcept {
  if (learner_) {
    learner_->take_reward(engine_.tick(), reward_.sample(frame_.active_fields), engine_.plastic_weights());
  }
}

void ControlLoop::step() noexcept {
  const auto turn = static_cast<TimeNs>(counters_.turns);
  const auto end = static_cast<std::uint64_t>((turn + 1) * options_.frame_period_ns / tick_ns_);
  frame_.tick = engine_.tick();
  while (engine_.tick() < end) {
    const std::uint64_t tick = engine_.tick();
    engine_.step();
    decoder_.tick(engine_.spikes());
    if (learner_) {
      learner_->take_spikes(engine_.spikes());
    }
    if (sink_ != nullptr) {
      sink_->take(tick, engine_.spikes());
    }
  }
}

void ControlLoop::decode(TimeNs now_ns) noexcept {
  TimeNs camera_age_ns = std::numeric_limits<TimeNs>::max();
  for (const EyeState& eye : eyes_) {
    if (eye.camera != nullptr) {
      camera_age_ns = std::min(camera_age_ns, now_ns - eye.fresh_ns);
    }
  }
  frame_.time_ns = now_ns;
  frame_.position_deg = feedback_.position_deg;
  frame_.fresh_mask = feedback_.fresh_mask;
  frame_.camera_age_ns = camera_age_ns;
  const GuardRequest request = request_.load(std::memory_order_relaxed);
  frame_.request = static_cast<std::uint8_t>(request);
  decoder_.decode(frame_.decoded_deg);
  has_command_ = guard_.decide({.now_ns = now_ns,
                                .decoded_deg = frame_.decoded_deg,
                                .feedback = feedback_,
                                .camera_age_ns = camera_age_ns,
                                .request = request},
                               command_);
  frame_.guard_state = static_cast<std::uint8_t>(guard_.state());
  frame_.has_command = has_command_;
  if (has_command_) {
    decoder_.accept(command_.goal_deg);
    frame_.goal_deg = command_.goal_deg;
  } else {
    frame_.goal_deg = feedback_.position_deg;
  }
}

void ControlLoop::write() noexcept {
  if (has_command_ && !ports_.servos.write(command_)) {
    ++counters_.failed_writes;
  }
}

}  // namespace tectum
