// What happens on a whole head when something fails: real threads, a real pseudo-terminal, real time. Nothing here
// depends on how fast the machine is; a condition is waited for, up to half a minute.
#include "tools/live/live_run.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "runtime/loop/replay.h"
#include "tests/loop/loop_fixture.h"

using namespace tectum;

namespace {

constexpr double kPatienceS = 30;

struct EmulatedRun {
  EmulatedRun() {
    HeadFile file;
    file.is_emulated = true;
    file.cameras[0].kind = file.cameras[1].kind = CameraKind::Simulated;
    SimHeadParams params;
    params.camera.field_of_view_deg = 40;
    params.camera.width_px = params.camera.height_px = 100;
    params.scenario.kind = ScenarioKind::Step;
    std::string error;
    head = LiveHead::open(file, params, 0, error);
    REQUIRE_MESSAGE(head != nullptr, error);
    options.duration_s = 0;
    options.ready_within_ns = 30'000 * kMs;
  }

  /// Until `script` says that it is over. It is called twenty times a second.
  LiveRun until(const std::function<bool(const LiveGlimpse&)>& script) {
    LiveRun run = run_live(image, *head, options, controls, [&](const LiveGlimpse& glimpse) {
      is_over = is_over || script(glimpse);
      controls.ends = controls.ends || is_over || glimpse.time_s > kPatienceS;
    });
    CHECK(run.error == "");
    CHECK(is_over);
    return run;
  }
  void bus(const std::function<void(Ax12Emulator&, TimeNs)>& change) {
    head->emulated()->plug().with_device([&](TimeNs now_ns) { change(head->emulated()->bus(), now_ns); });
  }
  void eyes(EyeFault fault) {
    for (const Eye eye : {Eye::Left, Eye::Right}) {
      head->emulated()->set_fault(eye, fault);
    }
  }
  bool has_torque(std::uint8_t id) {
    bool is_on = false;
    bus([&](Ax12Emulator& emulator, TimeNs) { is_on = emulator.find(id)->get(ax12::kTorqueEnable) != 0; });
    return is_on;
  }

  SpikeImage image = two_eyed_image(1.0);
  std::unique_ptr<LiveHead> head;
  LiveRunOptions options;
  LiveControls controls;
  bool is_over = false;
};

bool told(const LiveRun& run, const std::string& what) {
  return std::any_of(run.events.begin(), run.events.end(),
                     [&](const LiveEvent& event) { return event.text.find(what) != std::string::npos; });
}

/// The largest step of any goal from one turn to the next.
double largest_step_deg(const Recording& recording) {
  double largest = 0;
  for (std::size_t k = 1; k < recording.frames.size(); ++k) {
    for (std::size_t j = 0; j < 2; ++j) {
      largest = std::max(largest, std::abs(recording.frames[k].goal_deg[j] - recording.frames[k - 1].goal_deg[j]));
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("a run over a serial line tracks, parks, takes the torque off, and can be replayed") {
  EmulatedRun run;
  const LiveRun result = run.until([](const LiveGlimpse& g) { return g.frame.tick > 1000; });
  REQUIRE(result.recording.frames.size() > 20);
  CHECK(told(result, "guard: tracking"));
  CHECK(result.is_parked);
  CHECK_FALSE(run.has_torque(3));
  CHECK(result.figures.head.commands >= result.recording.frames.size() / 2);
  CHECK(result.figures.frame_to_last_byte.count() > 0);
  CHECK(result.recording.frames.back().has_truth);
  CHECK(result.figures.lost_frames == 0);
  CHECK(result.figures.lost_spikes == 0);
  const ReplayResult again = replay(run.image, result.recording);
  CHECK_MESSAGE(again.is_same, again.error << again.difference);
}

TEST_CASE("with both cameras gone the head holds, eases to neutral, and goes on when they are back") {
  EmulatedRun run;
  run.options.guard.neutral_deg = {4, 3, 0, 0, 0, 0};
  int step = 0;
  const LiveRun result = run.until([&](const LiveGlimpse& g) {
    if (step == 0 && g.state == GuardState::Tracking) {
      run.eyes(EyeFault::Unplugged);
      step = 1;
    } else if (step == 1 && g.state == GuardState::Easing && g.frame.goal_deg[0] == 4 && g.frame.goal_deg[1] == 3) {
      run.eyes(EyeFault::None);
      step = 2;
    }
    return step == 2 && g.state == GuardState::Tracking;
  });
  CHECK(told(result, "left eye: gone; is it unplugged?"));
  CHECK(told(result, "right eye: sees again"));
  CHECK(told(result, "guard: holding"));
  CHECK(told(result, "guard: easing"));
  CHECK(result.figures.guard.holds >= 1);
}

TEST_CASE("one eye alone is enough to go on") {
  EmulatedRun run;
  int step = 0;
  double since_s = 0;
  const LiveRun result = run.until([&](const LiveGlimpse& g) {
    if (step == 0 && g.state == GuardState::Tracking) {
      run.head->emulated()->set_fault(Eye::Left, EyeFault::Unplugged);
      step = 1;
      since_s = g.time_s;
    }
    return step == 1 && g.time_s > since_s + 1 && g.state == GuardState::Tracking;
  });
  CHECK(told(result, "left eye: gone"));
  CHECK_FALSE(told(result, "right eye: gone"));
}

TEST_CASE("a servo that drops off the bus is named and held, and goes on when it is back") {
  EmulatedRun run;
  int step = 0;
  const LiveRun result = run.until([&](const LiveGlimpse& g) {
    if (step == 0 && g.state == GuardState::Tracking) {
      run.bus([](Ax12Emulator& bus, TimeNs now_ns) { REQUIRE(bus.pull_plug(3, now_ns)); });
      step = 1;
    } else if (step == 1 && run.head->servos().report().joints[0].health == ServoHealth::Lost) {
      run.bus([](Ax12Emulator& bus, TimeNs now_ns) { REQUIRE(bus.plug_in(3, now_ns)); });
      step = 2;
    }
    return step == 2 && run.head->servos().report().joints[0].health == ServoHealth::Working &&
           g.state == GuardState::Tracking && run.has_torque(3);
  });
  CHECK(told(result, "servo 3 (left_eye_pan)"));
}

TEST_CASE("a port that vanishes is opened again when it is back") {
  EmulatedRun run;
  int step = 0;
  std::uint64_t before = 0;
  const LiveRun result = run.until([&](const LiveGlimpse& g) {
    if (step == 0 && g.state == GuardState::Tracking) {
      run.head->emulated()->plug().unplug();
      step = 1;
    } else if (step == 1 && !run.head->servos().report().is_connected) {
      std::string error;
      REQUIRE(run.head->emulated()->plug().plug_in(error));
      before = run.head->servos().report().commands;
      step = 2;
    }
    return step == 2 && run.head->servos().report().commands > before + 5;
  });
  CHECK(told(result, "the port is gone"));
  CHECK(told(result, "the port is back"));
  CHECK(result.figures.loop.failed_writes > 0);
}

TEST_CASE("an emergency stop holds the head where it is until the end, and the end does not jump") {
  EmulatedRun run;
  double stopped_s = 0;
  const LiveRun result = run.until([&](const LiveGlimpse& g) {
    if (g.state == GuardState::Tracking) {
      run.controls.request = GuardRequest::Stop;
    }
    stopped_s = g.state == GuardState::Stopped && stopped_s == 0 ? g.time_s : stopped_s;
    return stopped_s > 0 && g.time_s > stopped_s + 0.5;
  });
  CHECK(told(result, "guard: stopped"));
  const auto& frames = result.recording.frames;
  const auto stop = std::find_if(frames.begin(), frames.end(), [](const RecordedFrame& frame) {
    return frame.guard_state == static_cast<std::uint8_t>(GuardState::Stopped);
  });
  REQUIRE(stop != frames.end());
  CHECK(std::all_of(stop, frames.end(), [&](const RecordedFrame& frame) { return frame.goal_deg == stop->goal_deg; }));
}

TEST_CASE("torque can be taken from the whole head at once") {
  EmulatedRun run;
  const LiveRun result = run.until([&](const LiveGlimpse& g) {
    if (g.state == GuardState::Tracking) {
      run.controls.request = GuardRequest::Release;
    }
    return g.state == GuardState::Released && !run.has_torque(3) && !run.has_torque(4);
  });
  CHECK(told(result, "guard: released"));
}

TEST_CASE("a wire that damages one byte in a hundred, or in ten, moves no goal by more than its speed") {
  for (const double share : {0.01, 0.1}) {
    CAPTURE(share);
    EmulatedRun run;
    int step = 0;
    double since_s = 0;
    const LiveRun result = run.until([&](const LiveGlimpse& g) {
      if (step == 0 && g.state == GuardState::Tracking) {
        run.bus([&](Ax12Emulator& bus, TimeNs) { bus.noise.faults = WireFaults::bytes(share); });
        step = 1;
        since_s = g.time_s;
      } else if (step == 1 && g.time_s > since_s + 2) {
        run.bus([&](Ax12Emulator& bus, TimeNs) { bus.noise.faults = {}; });
        step = 2;
      }
      return step == 2 && g.state == GuardState::Tracking;
    });
    CHECK(result.figures.head.wire.troubles() > 0);
    CHECK(largest_step_deg(result.recording) < 1.5);  // the circuit asks for 0 or 1 deg
  }
}

TEST_CASE("a head without one of its servos is told which one, and nothing moves") {
  EmulatedRun run;
  HeadFile file = run.head->file();
  run.head.reset();
  file.is_emulated = false;
  std::string error;
  Ax12Emulator bus;
  for (std::uint8_t id = 1; id <= 5; ++id) {
    bus.add_servo(id);
  }
  const auto plug = PtyDevice::open(bus, {}, error);
  REQUIRE_MESSAGE(plug != nullptr, error);
  file.port = plug->path();
  file.cameras = {};
  const auto head = LiveHead::open(file, {}, 0, error);
  REQUIRE(head != nullptr);
  run.options.ready_within_ns = 1500 * kMs;
  const LiveRun result = run_live(run.image, *head, run.options, run.controls);
  CHECK(result.error == "no answer from right_eye_tilt (ID 6)");
  CHECK(result.recording.frames.empty());
}
