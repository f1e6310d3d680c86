#include "tools/evaluate/parallel_jobs.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace tectum {

void run_jobs(const std::vector<Job>& jobs, unsigned threads, const std::function<void(double)>& watch) {
  if (jobs.empty()) {
    return;
  }
  const std::size_t cores = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
  const std::size_t workers = std::min(jobs.size(), cores);
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> running{workers};
  std::vector<std::atomic<double>> done(jobs.size());
  const auto work = [&] {
    for (std::size_t mine = next++; mine < jobs.size(); mine = next++) {
      jobs[mine]([&done, mine](double share) { done[mine].store(share, std::memory_order_relaxed); });
      done[mine].store(1, std::memory_order_relaxed);
    }
    --running;
  };
  std::vector<std::jthread> team;
  for (std::size_t k = 0; k < workers; ++k) {
    team.emplace_back(work);
  }
  while (running.load() > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    double sum = 0;
    for (const std::atomic<double>& share : done) {
      sum += share.load(std::memory_order_relaxed);
    }
    if (watch) {
      watch(sum / static_cast<double>(jobs.size()));
    }
  }
}

}  // namespace tectum
