// From step() down nothing allocates.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/random_network.h"
#include "tests/support/test_network.h"

namespace {

std::atomic<std::uint64_t> allocations{0};

void* counted(std::size_t bytes) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* const memory = std::malloc(bytes == 0 ? 1 : bytes)) {
    return memory;
  }
  std::abort();
}

void* counted_aligned(std::size_t bytes, std::align_val_t alignment) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  const auto step = static_cast<std::size_t>(alignment);
  if (void* const memory = std::aligned_alloc(step, (bytes + step - 1) / step * step)) {
    return memory;
  }
  std::abort();
}

}  // namespace

void* operator new(std::size_t bytes) { return counted(bytes); }
void* operator new[](std::size_t bytes) { return counted(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) { return counted_aligned(bytes, alignment); }
void* operator new[](std::size_t bytes, std::align_val_t alignment) { return counted_aligned(bytes, alignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace tectum::test {
namespace {

constexpr std::uint64_t kTenSeconds = 100'000;  // ticks

// Runs with everything that a loop does between ticks, and returns how often memory was asked for.
std::uint64_t allocations_of_a_run(const SpikeImage& image, const EngineOptions& options, std::uint64_t ticks,
                                   bool tick_by_tick, std::uint64_t& spikes) {
  SpikeEngine engine(image, options);
  double seen = 0;
  const std::uint64_t before = allocations.load();
  engine.reset();
  while (engine.tick() < ticks) {
    engine.inject_spike(NeuronId{static_cast<std::uint32_t>(engine.tick() % image.header.neuron_count)});
    if (image.header.slot_count > 0) {
      engine.inject_input(SlotId{static_cast<std::uint32_t>(engine.tick() % image.header.slot_count)}, 1.0);
    }
    const std::uint32_t done = engine.advance(tick_by_tick ? 1 : 10);
    spikes += engine.spikes(done - 1).size();
    seen += engine.probe(NeuronId{0}, 0);
  }
  const std::uint64_t after = allocations.load();
  CHECK(seen == seen);  // not NaN
  return after - before;
}

TEST_CASE("10 s of ticks allocate nothing") {
  TestNetwork network;
  const std::uint32_t noise = network.add("noise", {ModelKind::Poisson, 50, {{"rate", {20.0}}}, {}, false});
  const std::uint32_t awake =
      network.add("awake", {ModelKind::LifExp, 100, {{"I_bias", {2.1}}}, {exponential("ex", 5)}, false});
  const std::uint32_t asleep =
      network.add("asleep", {ModelKind::LifExp, 100, {}, {exponential("ex", 5), exponential("in", 10)}, true});
  for (std::uint32_t i = 0; i < 100; ++i) {
    network.connect(noise + i % 50, awake + i, 1 + i % 30, 0.5);
    network.connect(awake + i, asleep + (7 * i) % 100, 1000 + i, 3.0, i % 2);
    network.connect(awake + i, asleep + (3 * i) % 100, 0, 2.0);
  }
  std::uint64_t spikes = 0;
  const SpikeImage image = build_image(network);
  CHECK(allocations_of_a_run(image, {}, kTenSeconds, true, spikes) == 0);
  CHECK(allocations_of_a_run(image, {}, kTenSeconds, false, spikes) == 0);
  CHECK(spikes > 10'000);
}

TEST_CASE("no model, strategy or thread allocates in a tick") {
  constexpr std::uint64_t kTicks = 200;
  std::uint64_t spikes = 0;
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    CAPTURE(seed);
    const LoadedImage loaded = load_image(write_image(random_image(seed)));
    REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
    for (const unsigned threads : {1U, 2U}) {
      CHECK(allocations_of_a_run(*loaded.image, {.threads = threads}, threads == 1 ? kTicks : kTicks / 4, false,
                                 spikes) == 0);
    }
  }
  CHECK(spikes > 1000);
}

TEST_CASE("the counter counts") {
  const std::uint64_t before = allocations.load();
  const std::vector<int> some(10, 1);
  CHECK(allocations.load() > before);
  CHECK(some.size() == 10);
}

}  // namespace
}  // namespace tectum::test
