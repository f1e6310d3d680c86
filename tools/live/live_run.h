// A circuit on a head, in real time.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "runtime/loop/control_loop.h"
#include "runtime/loop/real_time.h"
#include "runtime/record/recording.h"
#include "tools/live/live_head.h"

namespace tectum {

struct LiveRunOptions {
  double duration_s = 60;  // 0: until it is told to end
  TimeNs frame_period_ns = 22'222'222;
  std::string record_path;  // of the recording; empty for none
  bool keeps_recording = true;
  bool learns = false;     // weights change as the circuit declares
  std::string scenario;    // for the recording
  std::uint64_t seed = 0;  // same
  RealTimeOptions real_time;
  GuardOptions guard;
  EngineOptions engine;
  TimeNs ready_within_ns = 8'000'000'000;
  /// After the pictures' arrival, so that a frame that is a little late is still this turn's.
  TimeNs phase_ns = 3'000'000;
};

/// What is asked of a run while it goes on. May be set from signal handlers and other threads.
struct LiveControls {
  std::atomic<GuardRequest> request = GuardRequest::None;
  std::atomic<bool> ends = false;  // park, then torque off and back
  std::atomic<bool> ends_at_once = false;
};

/// What somebody who watches sees; copied between turns.
struct LiveGlimpse {
  double time_s = 0;
  GuardState state = GuardState::Waiting;
  std::uint32_t lost_mask = 0;
  RecordedFrame frame;
  std::vector<std::uint32_t> spikes_of_population;  // since the glimpse before
  LoopCounters counters;                            // turns, late turns and skipped periods; the others are 0
};

struct LiveFigures {
  LoopCounters loop;
  GuardCounters guard;
  std::uint64_t missed_deadlines = 0;   // turns whose command left after the turn's period, and periods slept through
  LatencyHistogram frame_to_command;    // from the loop taking the frames to the driver having the command
  LatencyHistogram frame_to_last_byte;  // from the loop taking the frames to the last byte in the kernel's hands
  LatencyHistogram exposure_to_turn;    // of the newer eye
  LatencyHistogram lateness;            // of a turn behind its schedule
  LatencyHistogram eye_skew;            // between the exposures of the two eyes
  std::array<LatencyHistogram, 5> stages;  // read, encode, step, decode, write
  HeadReport head;
  std::uint64_t lost_frames = 0, lost_spikes = 0;  // by the recorder
  double stolen_share = 0;                         // of the processors' time, by the host of a virtual machine
};

struct LiveRun {
  std::string error;  // one line: why there was no run, or why it ended early
  Recording recording;
  LiveFigures figures;
  std::vector<std::int32_t> learned_scales;  // of each plastic synapse, in 2^-kScaleBits; of a run that learns
  std::vector<LiveEvent> events;
  bool is_parked = false;
};

/// Calls `watch` about twenty times a second from the calling thread; may be empty. The loop has its own thread.
[[nodiscard]] LiveRun run_live(const SpikeImage& image, LiveHead& head, const LiveRunOptions& options,
                               LiveControls& controls, const std::function<void(const LiveGlimpse&)>& watch = {},
                               const std::function<void(const LiveEvent&)>& on_event = {});

/// Deadlines, latencies, wire and faults, as lines.
[[nodiscard]] std::string live_figures_text(const LiveRun& run);
/// The same as one JSON object: latency_ms, deadlines, bus, recorder.
[[nodiscard]] std::string live_figures_json(const LiveRun& run);

}  // namespace tectum
