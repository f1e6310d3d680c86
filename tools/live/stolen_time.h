// How much of the processors a virtual machine's host kept for itself: late turns that nobody inside can mend.
#pragma once

#include <optional>
#include <string>

namespace tectum {

/// From /proc/stat (proc(5)), in clock ticks since the machine started.
struct ProcessorTicks {
  double all = 0;
  double stolen = 0;
};

/// Of the text of /proc/stat; nothing when it has no such line or no column of stolen time.
[[nodiscard]] std::optional<ProcessorTicks> processor_ticks(const std::string& proc_stat);
/// Of this machine, now; nothing where there is no /proc/stat.
[[nodiscard]] std::optional<ProcessorTicks> processor_ticks_now();
/// Share of the processors' time that was stolen between the two, 0 to 1; 0 when no time has passed.
[[nodiscard]] double stolen_share(const ProcessorTicks& before, const ProcessorTicks& after);

}  // namespace tectum
