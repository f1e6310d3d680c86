// The closed loop: one turn reads the cameras, encodes the frames, steps the engine, decodes, guards and writes.
//
// Neural time is counted in turns, not read from a clock: the ticks that belong to turn k are
//   [floor(k * period / tick), floor((k + 1) * period / tick)),
// and they are run all at once as soon as turn k has its frames; their result is decoded and written at once, as on the
// head of 2020 (arXiv 2002.07534). So a turn's command rests on the newest frame, the engine has the rest of the
// period to be idle in, and the same frames give the same spikes whether they come in real or in virtual time.
//
// Turns start on an absolute schedule, start + k * period. A turn that is late by a whole period or more is counted,
// and the periods that it slept through are skipped; their ticks are never caught up.
//
// A loop that learns takes the reward off the frame that it has just encoded, before the turn's first tick: it is the
// newest that is known, and as late as the pictures are.
//
// A camera without a new frame leaves its eye's fields as they were. Once its newest frame is older than the guard's
// hold_after_ns the eye sees nothing, so that a picture from the past does not go on driving the circuit while the
// guard holds the head. One eye alone is enough to track.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/act/decoder.h"
#include "runtime/act/servo_guard.h"
#include "runtime/engine/spike_engine.h"
#include "runtime/learn/learner.h"
#include "runtime/learn/retinal_reward.h"
#include "runtime/loop/spike_sink.h"
#include "runtime/ports/camera.h"
#include "runtime/ports/clock.h"
#include "runtime/ports/servo_bus.h"
#include "runtime/record/recording.h"
#include "runtime/sense/retina.h"

namespace tectum {

/// The world around the loop. All of it outlives the loop.
struct LoopPorts {
  Camera* left = nullptr;
  Camera* right = nullptr;  // may be the left one
  ServoBus& servos;
  Clock& clock;
};

struct LoopOptions {
  TimeNs frame_period_ns = 22'222'222;  // 45 Hz, the rate of the 2020 head
  bool one_camera_both_eyes = false;    // without a right camera, the left one's frames go to both eyes
  bool learns = false;                  // weights change as the circuit declares (runtime/image/plasticity.h)
  bool measure_latency = false;         // reads the processor's clock; a virtual run leaves it off to be reproducible
  EngineOptions engine;
  GuardOptions guard;
};

enum class LoopStatus { Running, Ended };

/// What happened so far that should not, or is worth a line.
struct LoopCounters {
  std::uint64_t turns = 0;
  std::uint64_t late_turns = 0;                           // started a period or more behind the schedule
  std::uint64_t skipped_periods = 0;                      // that they slept through
  std::uint64_t failed_writes = 0;                        // the bus did not take the command
  std::array<std::uint64_t, kEyeCount> frames{};          // taken from each eye's camera
  std::array<std::uint64_t, kEyeCount> refused_frames{};  // of a size other than the first one's
  std::array<std::uint64_t, kEyeCount> failed_reads{};    // the camera says that it is gone
};

/// How long each stage of the last turn took on the processor; zeros unless LoopOptions::measure_latency.
struct StageTimes {
  TimeNs read_ns = 0, encode_ns = 0, step_ns = 0, decode_ns = 0, write_ns = 0;
};

class ControlLoop {
 public:
  /// Not real-time safe: allocates. `sink` may be null.
  ControlLoop(const SpikeImage& image, const LoopPorts& ports, const LoopOptions& options = {},
              SpikeSink* sink = nullptr);

  /// Waits for the next turn of the schedule and does it. Ended when a camera's recording is over; that turn does
  /// nothing. Real-time safe, but for each eye's first frame, whose size the retina prepares for.
  [[nodiscard]] LoopStatus turn() noexcept;

  /// The last turn. Its truth is empty: the loop does not know it.
  [[nodiscard]] const RecordedFrame& frame() const noexcept { return frame_; }

  /// From the next turn until the next call. May be called from a signal handler and from any thread.
  void request(GuardRequest request) noexcept { request_.store(request, std::memory_order_relaxed); }
  /// Takes the request back and lets the guard start again. Between turns only.
  void resume() noexcept;

  [[nodiscard]] SpikeEngine& engine() noexcept { return engine_; }
  /// Null unless LoopOptions::learns.
  [[nodiscard]] const Learner* learner() const noexcept { return learner_ ? &*learner_ : nullptr; }
  [[nodiscard]] const ServoGuard& guard() const noexcept { return guard_; }
  [[nodiscard]] const LoopCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const StageTimes& stage_times() const noexcept { return stage_times_; }

 private:
  struct Sheet {  // a retina and the input neurons that it drives
    Eye eye;
    Retina retina;
    std::uint32_t first_neuron;
    std::uint32_t first_recorded;  // its field 0 in RecordedFrame::active_fields of that eye
    std::vector<std::uint32_t> was_active;
  };
  struct EyeState {
    Camera* camera = nullptr;
    Frame frame;
    bool has_new_frame = false;
    bool has_size = false;
    bool is_stale = false;
    TimeNs fresh_ns = 0;  // when the newest frame was captured, or taken if its stamp lies in the future
  };

  [[nodiscard]] TimeNs wait_for_turn() noexcept;
  [[nodiscard]] LoopStatus read(TimeNs now_ns) noexcept;
  [[nodiscard]] CameraStatus read_eye(EyeState& eye, std::size_t index, TimeNs now_ns) noexcept;
  void encode(TimeNs now_ns) noexcept;
  void prepare_eye(std::size_t eye_index) noexcept;
  void drive(Sheet& sheet, std::span<const std::uint32_t> active) noexcept;
  void learn() noexcept;
  void step() noexcept;
  void decode(TimeNs now_ns) noexcept;
  void write() noexcept;

  LoopPorts ports_;
  LoopOptions options_;
  SpikeSink* sink_;
  TimeNs tick_ns_;
  SpikeEngine engine_;
  std::optional<Learner> learner_;
  RetinalReward reward_;
  Decoder decoder_;
  ServoGuard guard_;
  std::vector<Sheet> sheets_;
  std::array<EyeState, kEyeCount> eyes_;
  ServoFeedback feedback_;
  ServoCommand command_;
  bool has_command_ = false;
  std::atomic<GuardRequest> request_ = GuardRequest::None;
  bool has_started_ = false;
  TimeNs due_ns_ = 0;
  RecordedFrame frame_;
  LoopCounters counters_;
  StageTimes stage_times_;
};

}  // namespace tectum
