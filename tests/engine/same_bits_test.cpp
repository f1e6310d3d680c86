// What is computed never depends on how: strategy, instruction set, threads, ticks at once, optimisation.
#include <dlfcn.h>
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

#include "tests/engine/unoptimised/unoptimised_engine.h"
#include "tests/support/random_network.h"
#include "tests/support/run_digest.h"
#include "tests/support/test_network.h"

namespace tectum::test {
namespace {

constexpr std::uint64_t kCircuits = 512;
constexpr std::uint64_t kTicks = 160;
constexpr std::uint64_t kTicksOfThreads = 60;  // threads meet twice a slice, which is slow on a busy machine
constexpr SweepStrategy kSweeps[] = {SweepStrategy::Automatic, SweepStrategy::Dense, SweepStrategy::Sparse};
constexpr SimdLevel kSimd[] = {SimdLevel::Portable, SimdLevel::Avx2, SimdLevel::Avx512};

UnoptimisedRun load_unoptimised_engine() {
  // Beside the test's own binary.
  void* const library = ::dlopen(TECTUM_UNOPTIMISED_ENGINE, RTLD_NOW | RTLD_LOCAL);
  REQUIRE_MESSAGE((library != nullptr), ::dlerror());
  auto* const run = reinterpret_cast<UnoptimisedRun>(::dlsym(library, kUnoptimisedRunName));
  REQUIRE_MESSAGE((run != nullptr), kUnoptimisedRunName);
  return run;
}

// One circuit of a range, or the one that TECTUM_SEED names.
template <typename Check>
void for_each_seed(Check check) {
  if (const char* const only = std::getenv("TECTUM_SEED")) {
    check(std::stoull(only));
    return;
  }
  for (std::uint64_t seed = 0; seed < kCircuits; ++seed) {
    check(seed);
  }
}

TEST_CASE("a number of threads that is measured when the engine is built gives the same bits") {
  TestNetwork network;
  constexpr std::uint32_t kSize = 20'000;
  network.add("lif", {ModelKind::LifExp, kSize, {{"I_bias", {2.2}}}, {exponential("ex", 5)}, false});
  for (std::uint32_t i = 0; i < kSize; ++i) {
    network.connect(i, (i * 7919U) % kSize, 8 + i % 5, 1.0);
  }
  const SpikeImage image = build_image(network);
  CHECK(run_digest(image, {.threads = 0}, 400, 1, false) == run_digest(image, {.threads = 1}, 400, 1, true));
}

TEST_CASE("every strategy, instruction set, thread count and optimisation level gives the same bits") {
  const UnoptimisedRun run_unoptimised = load_unoptimised_engine();
  std::uint64_t spikes = 0;
  std::uint64_t events = 0;
  for_each_seed([&](std::uint64_t seed) {
    CAPTURE(seed);  // TECTUM_SEED=<seed> runs this circuit alone
    const std::vector<std::byte> bytes = write_image(random_image(seed));
    const LoadedImage loaded = load_image(bytes);
    REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
    const RunDigest expected = run_digest(*loaded.image, {}, kTicks, seed, true);
    CHECK(expected.dropped_rows == 0);
    spikes += expected.spikes;
    events += expected.synaptic_events;
    for (const SweepStrategy sweep : kSweeps) {
      for (const SimdLevel simd : kSimd) {
        CAPTURE(static_cast<int>(sweep));
        CAPTURE(static_cast<int>(simd));
        CHECK(run_digest(*loaded.image, {sweep, simd, 1}, kTicks, seed, false) == expected);
      }
    }
    const RunDigest expected_of_threads = run_digest(*loaded.image, {}, kTicksOfThreads, seed, true);
    for (const unsigned threads : {2U, 4U}) {
      CAPTURE(threads);
      const EngineOptions options{kSweeps[seed % 3], kSimd[seed / 3 % 3], threads};
      CHECK(run_digest(*loaded.image, options, kTicksOfThreads, seed, (seed & 1U) != 0) == expected_of_threads);
    }
    RunDigest unoptimised;
    const EngineOptions options{kSweeps[seed % 3], kSimd[seed / 3 % 3], 1};
    REQUIRE(run_unoptimised(bytes.data(), bytes.size(), &options, kTicks, seed, &unoptimised));
    CHECK(unoptimised == expected);
  });
  MESSAGE(spikes, " spikes, ", events, " synaptic events");
  CHECK(events > 100 * kTicks);
}

}  // namespace
}  // namespace tectum::test
