// Threads that work at the same time and meet in between.
#include <doctest/doctest.h>

#include <array>
#include <cstdint>

#include "runtime/engine/thread_team.h"

namespace tectum::test {
namespace {

constexpr unsigned kMembers = 4;  // more than most machines that test have processors, so that members sleep

struct Rally {
  ThreadTeam* team = nullptr;
  std::array<std::uint64_t, kMembers> done{};  // each member writes its own
  std::array<std::uint64_t, kMembers> seen{};  // the sum of all, as each member saw it after the meeting
  volatile std::uint64_t sink = 0;
};

void work_and_meet(void* context, unsigned member) noexcept {
  auto& rally = *static_cast<Rally*>(context);
  const std::uint64_t turns = (rally.done[member] * 7919U + member * 104729U) % 4096U;  // never the same member last
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    static_cast<void>(rally.sink);
  }
  ++rally.done[member];
  rally.team->meet();
  rally.seen[member] = 0;
  for (const std::uint64_t done : rally.done) {
    rally.seen[member] += done;
  }
}

TEST_CASE("no member of a team goes on before all have met, and none sleeps for ever") {
  constexpr std::uint64_t kTeams = 40;
  constexpr std::uint64_t kRounds = 250;
  for (std::uint64_t trial = 0; trial < kTeams; ++trial) {
    ThreadTeam team(kMembers);
    Rally rally;
    rally.team = &team;
    for (std::uint64_t round = 1; round <= kRounds; ++round) {
      team.run(work_and_meet, &rally);
      for (const std::uint64_t seen : rally.seen) {
        REQUIRE(seen == round * kMembers);
      }
    }
  }
}

}  // namespace
}  // namespace tectum::test
