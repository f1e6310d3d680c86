#include "runtime/engine/thread_team.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace tectum {
namespace {

// About 20 us of spinning: longer than a slice's imbalance, shorter than a time slice of the scheduler.
constexpr unsigned kSpins = 500;
// Then the processor has something else to do, and being woken is faster than waiting for a turn.
constexpr unsigned kYields = 20;

void pause_briefly() noexcept {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

}  // namespace

ThreadTeam::ThreadTeam(unsigned member_count) : member_count_(member_count) {
  for (unsigned member = 1; member < member_count_; ++member) {
    threads_.emplace_back([this, member] { serve(member); });
  }
}

ThreadTeam::~ThreadTeam() {
  is_over_.store(true, std::memory_order_relaxed);
  advance(round_);
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void ThreadTeam::wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) noexcept {
  for (unsigned turn = 0; turn < kSpins + kYields; ++turn) {
    if (value.load(std::memory_order_acquire) != old) {
      return;
    }
    if (turn < kSpins) {
      pause_briefly();
    } else {
      std::this_thread::yield();
    }
  }
  std::unique_lock lock(sleep_);
  wake_.wait(lock, [&] { return value.load(std::memory_order_acquire) != old; });
}

void ThreadTeam::advance(std::atomic<std::uint32_t>& value) noexcept {
  value.fetch_add(1, std::memory_order_release);
  // Who looked at the old value under the lock is asleep by now, and who looks later sees the new one.
  { const std::lock_guard lock(sleep_); }
  wake_.notify_all();
}

void ThreadTeam::serve(unsigned member) noexcept {
  for (std::uint32_t round = 0;; ++round) {
    wait_for_change(round_, round);
    if (is_over_.load(std::memory_order_relaxed)) {
      return;
    }
    work_(context_, member);
    meet();
  }
}

void ThreadTeam::meet() noexcept {
  const std::uint32_t meeting = meeting_.load(std::memory_order_relaxed);
  if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == member_count_) {
    arrived_.store(0, std::memory_order_relaxed);
    advance(meeting_);
  } else {
    wait_for_change(meeting_, meeting);
  }
}

void ThreadTeam::run(Work work, void* context) noexcept {
  work_ = work;
  context_ = context;
  advance(round_);
  work(context, 0);
  meet();
}

}  // namespace tectum
