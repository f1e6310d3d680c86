#include "runtime/loop/control_loop.h"

#include <doctest/doctest.h>

#include "runtime/loop/echo_servo_bus.h"
#include "tests/loop/loop_fixture.h"

using namespace tectum;

namespace {

using Fields = std::vector<std::uint32_t>;

/// A loop at 50 Hz with a tick of 1 ms: 20 ticks a turn.
struct World {
  Log log;
  ScriptedCamera left{"left", &log}, right{"right", &log};
  ScriptedServos servos{&log};
  ManualClock clock{&log};
  SpikeLog sink{&log};
  LoopOptions options;

  World() { options.frame_period_ns = 20 * kMs; }
  [[nodiscard]] LoopPorts two_cameras() { return {.left = &left, .right = &right, .servos = servos, .clock = clock}; }
};

}  // namespace

TEST_CASE("a turn waits, reads, steps and writes, in that order") {
  World world;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options, &world.sink);
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(world.log == Log{"sleep", "read left", "read right", "read servos", "ticks", "write"});
}

TEST_CASE("a turn's command rests on the frame read in the same turn") {
  World world;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options, &world.sink);
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(world.servos.commands.back().goal_deg[0] == 0);
  world.left.is_right_lit = true;
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.frame().active_fields[0] == Fields{1});
  CHECK(loop.frame().active_fields[1].empty());
  CHECK(loop.frame().tick == 20);
  CHECK(loop.frame().time_ns == 5'020 * kMs);
  CHECK(loop.frame().captured_ns[0] == 5'015 * kMs);
  CHECK(loop.frame().decoded_deg[0] == doctest::Approx(1));
  CHECK(loop.frame().goal_deg[0] == doctest::Approx(1));
  CHECK(world.servos.commands.back().goal_deg[0] == doctest::Approx(1));
  CHECK_FALSE(loop.frame().has_truth);
  REQUIRE(world.sink.spikes.size() == 20);
  CHECK(world.sink.spikes.front() == RecordedSpike{20, 1});
  CHECK(world.sink.spikes.back() == RecordedSpike{39, 1});
}

TEST_CASE("ticks are shared out between turns so that neural time never drifts from the schedule") {
  World world;
  world.options.frame_period_ns = 22'222'222;  // 222.2 ticks of 0.1 ms
  ControlLoop loop(two_eyed_image(0.1), world.two_cameras(), world.options, &world.sink);
  std::uint64_t longest = 0, shortest = 1000;
  for (int turn = 0; turn < 450; ++turn) {
    const std::uint64_t before = world.sink.ticks;
    REQUIRE(loop.turn() == LoopStatus::Running);
    longest = std::max(longest, world.sink.ticks - before);
    shortest = std::min(shortest, world.sink.ticks - before);
  }
  CHECK(shortest == 222);
  CHECK(longest == 223);
  CHECK(world.sink.ticks == 450ULL * 22'222'222 / 100'000);
}

TEST_CASE("an eye without a new frame keeps what it saw, and sees nothing once that is stale") {
  World world;
  world.left.is_right_lit = true;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options, &world.sink);
  REQUIRE(loop.turn() == LoopStatus::Running);
  world.left.status = CameraStatus::NoNewFrame;
  for (int turn = 0; turn < 12; ++turn) {  // 5 ms of latency and 240 ms of silence
    REQUIRE(loop.turn() == LoopStatus::Running);
    REQUIRE(loop.frame().active_fields[0] == Fields{1});
  }
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.frame().active_fields[0].empty());
  CHECK(loop.guard().state() == GuardState::Tracking);  // the right eye still sees
  world.left.status = CameraStatus::NewFrame;
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.frame().active_fields[0] == Fields{1});
}

TEST_CASE("the guard holds when both eyes are stale, and counts from the newest of them") {
  World world;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options, &world.sink);
  REQUIRE(loop.turn() == LoopStatus::Running);
  world.left.status = CameraStatus::Failed;
  REQUIRE(loop.turn() == LoopStatus::Running);
  world.right.status = CameraStatus::NoNewFrame;
  for (int turn = 0; turn < 12; ++turn) {
    REQUIRE(loop.turn() == LoopStatus::Running);
    REQUIRE(loop.guard().state() == GuardState::Tracking);
  }
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.guard().state() == GuardState::Holding);
  CHECK(loop.counters().failed_reads[0] == 14);
  CHECK(loop.counters().failed_reads[1] == 0);
}

TEST_CASE("the end of either recording ends the run, and that turn moves nothing") {
  World world;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options, &world.sink);
  REQUIRE(loop.turn() == LoopStatus::Running);
  world.right.status = CameraStatus::Ended;
  CHECK(loop.turn() == LoopStatus::Ended);
  CHECK(world.servos.commands.size() == 1);
  CHECK(world.sink.ticks == 20);
  CHECK(loop.counters().turns == 1);
}

TEST_CASE("without a right camera the right eye is blind, or sees with the left one's frames when told to") {
  for (const bool both : {false, true}) {
    CAPTURE(both);
    World world;
    world.left.is_left_lit = true;
    world.options.one_camera_both_eyes = both;
    ControlLoop loop(two_eyed_image(), {.left = &world.left, .servos = world.servos, .clock = world.clock},
                     world.options);
    REQUIRE(loop.turn() == LoopStatus::Running);
    REQUIRE(loop.turn() == LoopStatus::Running);
    CHECK(loop.frame().active_fields[0] == Fields{0});
    CHECK(loop.frame().active_fields[1] == (both ? Fields{0} : Fields{}));
    CHECK(loop.frame().goal_deg[1] == doctest::Approx(both ? 1 : 0));
  }
}

TEST_CASE("one camera named for both eyes is read once a turn") {
  World world;
  world.left.is_left_lit = true;
  ControlLoop loop(two_eyed_image(),
                   {.left = &world.left, .right = &world.left, .servos = world.servos, .clock = world.clock},
                   world.options);
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(std::count(world.log.begin(), world.log.end(), "read left") == 1);
  CHECK(loop.frame().active_fields[1] == Fields{0});
}

TEST_CASE("a camera that changes its picture's size is counted and not seen") {
  World world;
  world.left.is_left_lit = true;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options);
  REQUIRE(loop.turn() == LoopStatus::Running);
  world.left.side_px = 20;
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.frame().active_fields[0].empty());
  CHECK(loop.counters().refused_frames[0] == 1);
  CHECK(loop.counters().refused_frames[1] == 0);
  world.left.side_px = 10;
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.frame().active_fields[0] == Fields{0});
}

TEST_CASE("turns start on an absolute schedule, and periods slept through are skipped and counted") {
  World world;
  world.clock.late_ns = {0, 3 * kMs, 0, 47 * kMs, 0};
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options, &world.sink);
  for (int turn = 0; turn < 5; ++turn) {
    REQUIRE(loop.turn() == LoopStatus::Running);
  }
  const TimeNs start = 5'000 * kMs;
  CHECK(world.clock.wakes_ns ==
        std::vector<TimeNs>{start, start + 20 * kMs, start + 40 * kMs, start + 60 * kMs, start + 120 * kMs});
  CHECK(loop.counters().late_turns == 1);
  CHECK(loop.counters().skipped_periods == 2);
  CHECK(world.sink.ticks == 100);  // a turn has its ticks, and no more, however late it is
}

TEST_CASE("a command that the bus does not take is counted") {
  World world;
  world.servos.is_writable = false;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options);
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.counters().failed_writes == 1);
}

TEST_CASE("nothing is written before the servos have said where they are") {
  World world;
  world.servos.fresh_mask = 0;
  world.servos.position_deg[0] = 12;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options);
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(world.servos.commands.empty());
  CHECK(loop.frame().goal_deg[0] == 12);
  world.servos.fresh_mask = 0b11;
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(world.servos.commands.back().goal_deg[0] == 12);
}

TEST_CASE("a stop asked for from outside holds from the next turn until it is resumed") {
  World world;
  world.left.is_right_lit = true;
  ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options);
  for (int turn = 0; turn < 3; ++turn) {
    REQUIRE(loop.turn() == LoopStatus::Running);
  }
  loop.request(GuardRequest::Stop);
  world.left.is_right_lit = false;
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.guard().state() == GuardState::Stopped);
  CHECK(world.servos.commands.back().goal_deg[0] == doctest::Approx(1));
  loop.resume();
  REQUIRE(loop.turn() == LoopStatus::Running);
  REQUIRE(loop.turn() == LoopStatus::Running);
  CHECK(loop.guard().state() == GuardState::Tracking);
  CHECK(world.servos.commands.back().goal_deg[0] == 0);
}

TEST_CASE("stages are timed only when asked, so that a virtual run reads no clock but its own") {
  for (const bool measures : {false, true}) {
    World world;
    world.options.measure_latency = measures;
    ControlLoop loop(two_eyed_image(), world.two_cameras(), world.options);
    REQUIRE(loop.turn() == LoopStatus::Running);
    CHECK((loop.stage_times().step_ns > 0) == measures);
  }
}

TEST_CASE("the echo bus measures every joint where it was told to be") {
  EchoServoBus bus;
  ServoFeedback feedback;
  bus.read(3, feedback);
  CHECK(feedback.measured_ns == 3);
  CHECK(feedback.fresh_mask == 0b111111);
  CHECK(feedback.position_deg == std::array<double, kJointCount>{});
  CHECK(bus.write({.issued_ns = 4, .goal_deg = {1, 2, 3, 4, 5, 6}}));
  bus.read(5, feedback);
  CHECK(feedback.position_deg == std::array<double, kJointCount>{1, 2, 3, 4, 5, 6});
}
