#include "tools/live/stolen_time.h"

#include <fstream>
#include <iterator>
#include <sstream>

namespace tectum {

std::optional<ProcessorTicks> processor_ticks(const std::string& proc_stat) {
  // user nice system idle iowait irq softirq steal; what guests got is counted in user and nice already.
  constexpr int kColumns = 8;
  std::istringstream line(proc_stat.substr(0, proc_stat.find('\n')));
  std::string name;
  if (!(line >> name) || name != "cpu") {
    return std::nullopt;
  }
  ProcessorTicks ticks;
  for (int column = 0; column < kColumns; ++column) {
    if (!(line >> ticks.stolen)) {
      return std::nullopt;
    }
    ticks.all += ticks.stolen;
  }
  return ticks;
}

std::optional<ProcessorTicks> processor_ticks_now() {
  std::ifstream file("/proc/stat");
  return processor_ticks({std::istreambuf_iterator<char>(file), {}});
}

double stolen_share(const ProcessorTicks& before, const ProcessorTicks& after) {
  const double passed = after.all - before.all;
  return passed > 0 ? (after.stolen - before.stolen) / passed : 0;
}

}  // namespace tectum
