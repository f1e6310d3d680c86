// A few threads that do the same work at the same time and meet in between.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace tectum {

/// The caller of run() is member 0. Waiting spins, and after a while sleeps until it is woken, so a
/// team is for throughput; a loop with deadlines uses one thread.
class ThreadTeam {
 public:
  /// Not real-time safe: starts member_count - 1 threads.
  explicit ThreadTeam(unsigned member_count);
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;
  ~ThreadTeam();

  using Work = void (*)(void* context, unsigned member) noexcept;
  /// Every member does `work`; returns when all are done.
  void run(Work work, void* context) noexcept;
  /// Called by every member within run(): none goes on before all have come here.
  void meet() noexcept;
  [[nodiscard]] unsigned member_count() const noexcept { return member_count_; }

 private:
  void serve(unsigned member) noexcept;
  /// Returns once `value`, one of the counters below, is no longer `old`.
  void wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) noexcept;
  /// Adds 1 to a counter and wakes who sleeps over it.
  void advance(std::atomic<std::uint32_t>& value) noexcept;

  unsigned member_count_;
  Work work_ = nullptr;
  void* context_ = nullptr;
  alignas(64) std::atomic<std::uint32_t> round_{0};    // how often run() was called
  alignas(64) std::atomic<std::uint32_t> arrived_{0};  // at the meeting point
  alignas(64) std::atomic<std::uint32_t> meeting_{0};  // how many meetings are over
  std::atomic<bool> is_over_{false};
  std::mutex sleep_;
  std::condition_variable wake_;
  std::vector<std::thread> threads_;
};

}  // namespace tectum
