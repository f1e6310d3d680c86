// What an operating system can do so that a loop keeps its time; and time itself.
#pragma once

#include <string>
#include <vector>

#include "runtime/ports/clock.h"

namespace tectum {

struct RealTimeOptions {
  int fifo_priority = 0;  // 1 to 99: SCHED_FIFO; 0: as other programs
  bool locks_memory = false;
  int core = -1;  // run on this one alone; -1: wherever
};

/// For the calling thread; memory for the whole process. One line for each thing that was not permitted, saying what
/// would permit it. Without them the loop runs, only less punctually.
[[nodiscard]] std::vector<std::string> enter_real_time(const RealTimeOptions& options);

/// CLOCK_MONOTONIC: not moved by those who set the time of day. Stops while the machine sleeps.
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] TimeNs now_ns() noexcept override;
  void sleep_until(TimeNs when_ns) noexcept override;
};

}  // namespace tectum
