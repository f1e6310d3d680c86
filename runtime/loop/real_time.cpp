#include "runtime/loop/real_time.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <cerrno>
#include <cstring>

namespace tectum {
namespace {

constexpr TimeNs kSecondNs = 1'000'000'000;

}  // namespace

std::vector<std::string> enter_real_time(const RealTimeOptions& options) {
  std::vector<std::string> refused;
  if (options.fifo_priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = options.fifo_priority;
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
    if (error != 0) {
      refused.push_back("no real-time priority (" + std::string(std::strerror(error)) +
                        "): allow it with `ulimit -r 90`, or a line `@realtime - rtprio 90` in "
                        "/etc/security/limits.conf");
    }
  }
  if (options.locks_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    refused.push_back("memory is not locked (" + std::string(std::strerror(errno)) +
                      "): allow it with `ulimit -l unlimited`");
  }
  if (options.core >= 0) {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    int error = EINVAL;
    if (options.core < CPU_SETSIZE) {
      CPU_SET(static_cast<std::size_t>(options.core), &cores);
      error = pthread_setaffinity_np(pthread_self(), sizeof cores, &cores);
    }
    if (error != 0) {
      refused.push_back("not on core " + std::to_string(options.core) + " (" + std::strerror(error) +
                        "): `nproc` says how many there are, counted from 0");
    }
  }
  return refused;
}

TimeNs MonotonicClock::now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<TimeNs>(now.tv_sec) * kSecondNs + now.tv_nsec;
}

void MonotonicClock::sleep_until(TimeNs when_ns) noexcept {
  const timespec when{static_cast<time_t>(when_ns / kSecondNs), static_cast<long>(when_ns % kSecondNs)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR) {
  }
}

}  // namespace tectum
