#include "runtime/loop/replay.h"

#include <doctest/doctest.h>

#include <random>

#include "runtime/record/recording_file.h"
#include "tests/loop/loop_fixture.h"

using namespace tectum;

namespace {

/// Cameras that come and go, servos that drop out, a stop: everything that a command rests on.
Recording lively_run(const SpikeImage& image, std::uint64_t turns) {
  ScriptedCamera left, right;
  ScriptedServos servos;
  ManualClock clock;
  SpikeLog sink;
  LoopOptions options;
  options.frame_period_ns = 22'222'222;
  options.guard.neutral_deg[0] = 3;
  Recording run = describe_run(image);
  describe_guard(options.guard, run);
  run.frame_period_ns = options.frame_period_ns;
  ControlLoop loop(image, {.left = &left, .right = &right, .servos = servos, .clock = clock}, options, &sink);
  std::mt19937 random(1);
  for (std::uint64_t k = 0; k < turns; ++k) {
    left.is_left_lit = random() % 2 == 0;
    left.is_right_lit = random() % 3 == 0;
    right.is_left_lit = random() % 2 == 0;
    const bool is_gap = k >= 40 && k < 110;
    left.status = right.status = is_gap ? CameraStatus::NoNewFrame : CameraStatus::NewFrame;
    servos.fresh_mask = k >= 130 && k < 160 ? 0b111110 : 0b111111;
    servos.position_deg[1] += 0.01 * static_cast<double>(random() % 10);
    if (k % 17 == 0) {
      clock.late_ns.push_back(static_cast<TimeNs>(random() % 60) * kMs);
    }
    loop.request(k >= 180 ? GuardRequest::Stop : GuardRequest::None);
    REQUIRE(loop.turn() == LoopStatus::Running);
    run.frames.push_back(loop.frame());
  }
  run.spikes = sink.spikes;
  return run;
}

}  // namespace

TEST_CASE("a recorded run is the same again, bit for bit, gaps and stops included") {
  const SpikeImage image = two_eyed_image(0.1);
  const Recording run = lively_run(image, 200);
  const ReplayResult result = replay(image, run);
  CHECK(result.error == "");
  CHECK_MESSAGE(result.is_same, result.difference);
  CHECK(result.frames == 200);
  CHECK(result.spikes == run.spikes.size());
  CHECK(result.spikes > 1000);
  CHECK(result.commands == 200);
}

TEST_CASE("the image in a recording is the one that ran") {
  const SpikeImage image = two_eyed_image(0.1);
  const LoadedImage again = load_image(describe_run(image).image);
  REQUIRE(again.image.has_value());
  CHECK(again.image->header.checksum == image.header.checksum);
}

TEST_CASE("the first spike, angle or command that differs is named") {
  const SpikeImage image = two_eyed_image(0.1);
  const Recording run = lively_run(image, 60);
  Recording one = run;
  one.spikes.erase(one.spikes.begin() + 100);
  CHECK(replay(image, one).difference.find("which the recording does not say") != std::string::npos);
  one = run;
  one.spikes.insert(one.spikes.begin() + 100, {one.spikes[100].tick, one.spikes[100].neuron + 1});
  CHECK_FALSE(replay(image, one).is_same);
  one = run;
  one.frames[30].decoded_deg[1] = std::nextafter(one.frames[30].decoded_deg[1], 100.0);
  CHECK(replay(image, one).difference == "frame 30: the decoder says other angles");
  one = run;
  one.frames[31].goal_deg[0] += 1e-12;
  CHECK(replay(image, one).difference == "frame 31: another command is sent");
  one = run;
  one.frames[55].camera_age_ns = 0;  // it was holding
  CHECK(replay(image, one).difference == "frame 55: the guard is tracking, and was another");
  one = run;
  std::vector<std::uint32_t>& seen = one.frames[20].active_fields[0];
  seen = seen.empty() ? std::vector<std::uint32_t>{0} : std::vector<std::uint32_t>{};
  CHECK_FALSE(replay(image, one).is_same);
}

TEST_CASE("a recording cut anywhere between turns replays up to there") {
  const SpikeImage image = two_eyed_image(0.1);
  Recording run = lively_run(image, 60);
  run.frames.resize(37);
  const ReplayResult result = replay(image, run);
  CHECK(result.is_same);
  CHECK(result.frames == 37);
}

TEST_CASE("a recording of another circuit, and one that makes no sense, are refused") {
  const SpikeImage image = two_eyed_image(0.1);
  const Recording run = lively_run(image, 10);
  CHECK(replay(two_eyed_image(1.0), run).error.find("another circuit") != std::string::npos);
  const ReplayResult other = replay(two_eyed_image(1.0), run, {.engine = {}, .takes_other_circuit = true});
  CHECK(other.is_other_circuit);
  CHECK(other.error == "its ticks are not the circuit's");
  Recording one = run;
  one.frames.erase(one.frames.begin() + 4);
  CHECK(replay(image, one).error == "frame 4 starts at tick 1111, not 888");
  one = run;
  one.frames[3].active_fields[1] = {7};
  CHECK(replay(image, one).error == "frame 3 lights a field that the circuit does not have");
}
