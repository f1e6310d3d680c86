#include "runtime/record/recorder_thread.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "runtime/record/recording_file.h"
#include "tests/record/recording_fixture.h"

using namespace tectum;

namespace {

RecorderOptions to_file(const std::string& path) {
  RecorderOptions options;
  options.path = path;
  return options;
}

void play(const Recording& run, RecorderThread& recorder, std::size_t from, std::size_t to) {
  for (std::size_t k = from; k < to; ++k) {
    for (std::size_t s = 0; s < run.spikes.size(); ++s) {
      const std::uint64_t end = k + 1 < run.frames.size() ? run.frames[k + 1].tick : ~std::uint64_t{0};
      if (run.spikes[s].tick >= run.frames[k].tick && run.spikes[s].tick < end) {
        const NeuronId neuron{run.spikes[s].neuron};
        recorder.take(run.spikes[s].tick, {&neuron, 1});
      }
    }
    recorder.frame(run.frames[k]);
  }
}

}  // namespace

TEST_CASE("what the loop hands over is in the file and in memory, in order") {
  const ScratchPath path("thread.rec");
  const Recording run = small_recording(50);
  RecorderThread recorder;
  std::size_t watched = 0;
  REQUIRE(recorder.start(
              run, {.path = path.str(), .keeps = true, .watch = [&](const auto&, const auto&) { ++watched; }}) == "");
  play(run, recorder, 0, 50);
  recorder.end_turns();
  play(run, recorder, 0, 3);
  REQUIRE(recorder.finish(run.duration_s) == "");
  CHECK(recorder.lost_spikes() == 0);
  CHECK(recorder.lost_frames() == 0);
  CHECK(watched == 50);
  const ReadRecording read = read_recording(path.str());
  REQUIRE(read.error == "");
  CHECK_FALSE(read.is_truncated);
  REQUIRE(read.recording.frames.size() == 50);
  for (std::size_t k = 0; k < 50; ++k) {
    REQUIRE(same_frame(read.recording.frames[k], run.frames[k]));
    REQUIRE(same_frame(recorder.recording().frames.at(50 + k), run.frames[k]));  // behind the run's own
  }
  CHECK(read.recording.spikes == run.spikes);
}

TEST_CASE("a loop that the recorder cannot follow loses whole turns, and is told how many") {
  const Recording run = small_recording(1);
  RecorderThread recorder;
  std::atomic<bool> may_go = false;
  const auto slow = [&](const auto&, const auto&) {
    while (!may_go) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  REQUIRE(recorder.start(run, {.path = "", .keeps = true, .slots = 4, .spikes_per_turn = 2, .watch = slow}) == "");
  const std::array<NeuronId, 3> fired = {NeuronId{0}, NeuronId{1}, NeuronId{2}};
  for (int k = 0; k < 10; ++k) {
    recorder.take(static_cast<std::uint64_t>(k), fired);
    recorder.frame(run.frames[0]);
  }
  CHECK(recorder.lost_frames() == 6);
  CHECK(recorder.lost_spikes() == 4);
  may_go = true;
  REQUIRE(recorder.finish(1) == "");
  CHECK(recorder.recording().frames.size() == 1 + 4);
}

TEST_CASE("kill -9 leaves every block that was written, and the file says where it ends") {
  const ScratchPath path("killed.rec");
  const Recording run = small_recording(100);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    RecorderThread recorder;
    if (!recorder.start(run, to_file(path.str())).empty()) {
      _exit(1);
    }
    play(run, recorder, 0, 60);
    for (;;) {  // as if it went on
      pause();
    }
  }
  for (int wait_ms = 0; wait_ms < 20'000; wait_ms += 20) {  // three blocks of 16 turns fit into 60
    const ReadRecording so_far = read_recording(path.str());
    if (so_far.error.empty() && so_far.recording.frames.size() == 48) {
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const ReadRecording read = read_recording(path.str());
  REQUIRE(read.error == "");
  CHECK(read.is_truncated);
  CHECK(read.recording.frames.size() == 48);
  CHECK(read.ending.find("without an end block: 48 frames are whole") != std::string::npos);
  for (std::size_t k = 0; k < read.recording.frames.size(); ++k) {
    REQUIRE(same_frame(read.recording.frames[k], run.frames[k]));
  }
}

TEST_CASE("a recording that cannot be written is told at the start") {
  RecorderThread recorder;
  CHECK(recorder.start(small_recording(1), to_file("/nowhere/at/all.rec")) != "");
}
