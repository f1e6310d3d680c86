#include "runtime/engine/event_wheel.h"

#include <algorithm>
#include <bit>

namespace tectum {
namespace {

// 2^23 chunks are 2 GB of address space and 260 million waiting spikes.
constexpr std::uint64_t kMaxChunks = 1U << 23U;

}  // namespace

EventWheel::EventWheel(std::uint32_t max_delay_ticks, std::uint64_t max_rows)
    : mask_(std::bit_ceil(std::uint64_t{max_delay_ticks} + 1) - 1), heads_(mask_ + 1, kNone) {
  // Every bucket may end in a chunk that is partly empty.
  const std::uint64_t wanted = max_rows / kChunkEntries + std::min(max_rows, mask_ + 1) + 2;
  capacity_ = static_cast<std::uint32_t>(std::min(wanted, kMaxChunks));
  chunks_ = std::make_unique_for_overwrite<Chunk[]>(capacity_);
}

void EventWheel::clear() noexcept {
  std::fill(heads_.begin(), heads_.end(), kNone);
  used_ = 0;
  free_ = kNone;
  dropped_ = 0;
}

}  // namespace tectum
