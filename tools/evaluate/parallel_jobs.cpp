#include "tools/evaluate/parallel_jobs.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace tectum {
namespace {
constexpr std::chrono::milliseconds kWatchPeriod(100);
}

void run_jobs(const std::vector<Job>& jobs, unsigned threads, const std::function<void(double)>& watch) {
  if (jobs.empty()) {
    return;
  }
  const std::size_t cores = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
  const std::size_t workers = std::min(jobs.size(), cores);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;  // guards `running`
  std::condition_variable is_done;
  std::size_t running = workers;
  std::vector<std::atomic<double>> done(jobs.size());
  const auto work = [&] {
    for (std::size_t mine = next++; mine < jobs.size(); mine = next++) {
      jobs[mine]([&done, mine](double share) { done[mine].store(share, std::memory_order_relaxed); });
      done[mine].store(1, std::memory_order_relaxed);
    }
    const std::lock_guard lock(mutex);
    if (--running == 0) {
      is_done.notify_one();
    }
  };
  std::vector<std::jthread> team;
  for (std::size_t k = 0; k < workers; ++k) {
    team.emplace_back(work);
  }
  std::unique_lock lock(mutex);
  while (!is_done.wait_for(lock, kWatchPeriod, [&] { return running == 0; })) {
    if (!watch) {
      continue;
    }
    double sum = 0;
    for (const std::atomic<double>& share : done) {
      sum += share.load(std::memory_order_relaxed);
    }
    lock.unlock();
    watch(sum / static_cast<double>(jobs.size()));
    lock.lock();
  }
  if (watch) {
    watch(1);
  }
}

}  // namespace tectum
