// Nothing that a turn does may allocate: the whole test binary counts.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "runtime/loop/control_loop.h"
#include "runtime/loop/echo_servo_bus.h"
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
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

using namespace tectum;

namespace {

class CountingSink final : public SpikeSink {
 public:
  std::uint64_t spikes = 0;
  void take(std::uint64_t /*tick*/, std::span<const NeuronId> fired) noexcept override { spikes += fired.size(); }
};

class PlainClock final : public Clock {
 public:
  [[nodiscard]] TimeNs now_ns() noexcept override { return now_ns_; }
  void sleep_until(TimeNs when_ns) noexcept override { now_ns_ = when_ns; }

 private:
  TimeNs now_ns_ = 0;
};

}  // namespace

TEST_CASE("ten seconds of turns allocate nothing once the first frame is in") {
  ScriptedCamera left, right;
  EchoServoBus servos;
  PlainClock clock;
  CountingSink sink;
  LoopOptions options;
  options.measure_latency = true;
  ControlLoop loop(two_eyed_image(0.1), {.left = &left, .right = &right, .servos = servos, .clock = clock}, options,
                   &sink);
  REQUIRE(loop.turn() == LoopStatus::Running);
  const std::size_t before = allocations;
  bool is_running = true;
  for (int turn = 0; turn < 450 && is_running; ++turn) {
    left.is_left_lit = turn % 3 == 0;
    left.is_right_lit = turn % 2 == 0;
    right.is_left_lit = turn % 5 != 0;
    right.status = turn % 7 == 0 ? CameraStatus::NoNewFrame : CameraStatus::NewFrame;
    is_running = loop.turn() == LoopStatus::Running;
  }
  CHECK(allocations == before);
  CHECK(is_running);
  CHECK(sink.spikes > 1000);
}
