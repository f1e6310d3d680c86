#include "compiler/peak_memory.h"

#include <fstream>
#include <string>

namespace tectum {

void reset_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << "5\n";  // proc(5): resets VmHWM
}

std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) {
      return std::stoull(line.substr(6)) * 1024;  // in kB
    }
  }
  return 0;
}

}  // namespace tectum
