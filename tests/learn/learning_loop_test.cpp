// A loop that learns: what it changes, what it asks of the machine, and whether it can be had again.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <random>

#include "runtime/loop/control_loop.h"
#include "runtime/loop/replay.h"
#include "runtime/record/recording_file.h"
#include "tests/learn/learning_fixture.h"
#include "tests/loop/loop_fixture.h"

namespace {
std::atomic<std::size_t> allocations = 0;

void* counted(std::size_t bytes) {
  ++allocations;
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) {
    return memory;
  }
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t bytes) { return counted(bytes); }
void* operator new[](std::size_t bytes) { return counted(bytes); }
// The library's algorithms ask for their buffers by this one.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(bytes == 0 ? 1 : bytes);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace tectum::test {
namespace {

const std::string kRule = R"("reward": "pan", "learning_rate": "3 Hz")";

/// A left eye whose picture is lit in one half, both or none, by chance; 450 turns.
class LearningRun {
 public:
  LearningRun(const SpikeImage& image, bool learns)
      : loop_(image, {.left = &left_, .right = nullptr, .servos = servos_, .clock = clock_}, options(learns), &log_),
        run_(describe_run(image)) {
    describe_guard({}, run_);
    run_.frame_period_ns = options(learns).frame_period_ns;
    run_.learns = learns;
    run_.frames.reserve(kTurns);
    log_.spikes.reserve(1'000'000);
    servos_.commands.reserve(kTurns);
    clock_.wakes_ns.reserve(kTurns);
    turn();  // the first frame's size, and what the test's own world allocates
  }

  void turns() {
    for (int k = 1; k < kTurns && is_running_; ++k) {
      turn();
    }
  }
  [[nodiscard]] bool is_running() const { return is_running_; }
  [[nodiscard]] ControlLoop& loop() { return loop_; }
  [[nodiscard]] std::vector<RecordedSpike>& spikes() { return log_.spikes; }

  /// Turn by turn, with what a recording keeps.
  Recording recorded() {
    run_.frames.push_back(loop_.frame());
    for (int k = 1; k < kTurns && is_running_; ++k) {
      turn();
      run_.frames.push_back(loop_.frame());
    }
    run_.spikes = log_.spikes;
    return run_;
  }

 private:
  static constexpr int kTurns = 450;

  static LoopOptions options(bool learns) {
    LoopOptions options;
    options.learns = learns;
    return options;
  }
  void turn() {
    left_.is_left_lit = random_() % 2 == 0;
    left_.is_right_lit = random_() % 3 == 0;
    is_running_ = loop_.turn() == LoopStatus::Running && is_running_;
  }

  ScriptedCamera left_;
  ScriptedServos servos_;
  ManualClock clock_;
  SpikeLog log_;
  ControlLoop loop_;
  Recording run_;
  std::mt19937 random_{1};
  bool is_running_ = true;
};

}  // namespace

TEST_CASE("weights change in a loop that learns, and in no other") {
  const SpikeImage image = loaded(compiled(noisy_circuit(kRule)));
  for (const bool learns : {false, true}) {
    CAPTURE(learns);
    LearningRun run(image, learns);
    run.turns();
    const std::span<const std::int32_t> weights = run.loop().engine().plastic_weights();
    CHECK(std::equal(weights.begin(), weights.end(), image.weights.begin()) == !learns);
    CHECK((run.loop().learner() != nullptr) == learns);
  }
}

// The weights are powers of two and their sums, which any quantum represents: room for growth may make it coarser.
TEST_CASE("a circuit that could learn fires as one that cannot while it does not") {
  LearningRun plastic(loaded(compiled(noisy_circuit(kRule))), false);
  LearningRun fixed(loaded(compiled(unlearned(noisy_circuit(kRule)))), false);
  plastic.turns();
  fixed.turns();
  CHECK(plastic.spikes() == fixed.spikes());
  CHECK(plastic.spikes().size() > 1000);
}

TEST_CASE("ten seconds of learning allocate nothing once the first frame is in") {
  LearningRun run(loaded(compiled(noisy_circuit(kRule))), true);
  const std::size_t before = allocations;
  run.turns();
  CHECK(allocations == before);
  CHECK(run.is_running());
  CHECK(run.spikes().size() > 1000);
}

TEST_CASE("a recorded run that learned is the same again, and says how many weights it learned") {
  const SpikeImage image = loaded(compiled(noisy_circuit(kRule)));
  LearningRun run(image, true);
  Recording recording = run.recorded();
  const LoadedImage kept = load_image(recording.image);  // what a recording needs, it holds
  REQUIRE_MESSAGE(kept.image.has_value(), kept.error);
  const ReplayResult again = replay(*kept.image, recording);
  CHECK(again.error == "");
  CHECK_MESSAGE(again.is_same, again.difference);
  CHECK(again.learned > 40);
  CHECK(again.spikes == recording.spikes.size());
  // The weights are a part of what ran: without learning, the spikes part.
  recording.learns = false;
  CHECK_FALSE(replay(image, recording).is_same);
}

}  // namespace tectum::test
