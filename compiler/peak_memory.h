// How much memory the process has held, for --stats.
#pragma once

#include <cstdint>

namespace tectum {

/// Lets peak_memory_bytes() count from now on, where the system can (Linux); elsewhere it counts from the start.
void reset_peak_memory();

/// The most resident memory of the process; 0 where the system does not say.
[[nodiscard]] std::uint64_t peak_memory_bytes();

}  // namespace tectum
