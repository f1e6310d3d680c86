// Rows of spikes on their way: which segment of which row is due at which tick.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace tectum {

/// A spike waits here once, as its row's next undelivered segment [segment, row_end).
struct DueRow {
  std::uint32_t segment;
  std::uint32_t row_end;
};

/// A ring of tick buckets over one pool of fixed chunks. Nothing allocates after construction.
class EventWheel {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  static constexpr std::uint32_t kChunkEntries = 31;
  struct Chunk {
    std::uint32_t next;
    std::uint32_t count;
    DueRow rows[kChunkEntries];
  };
  static_assert(sizeof(Chunk) == 256);

  /// Not real-time safe. Holds rows up to `max_delay_ticks` ahead; at most `max_rows` at a time are
  /// sure to find room.
  EventWheel(std::uint32_t max_delay_ticks, std::uint64_t max_rows);

  void clear() noexcept;

  /// Real-time safe. A row that finds no room is dropped and counted.
  void push(std::uint64_t tick, DueRow row) noexcept {
    std::uint32_t& head = heads_[tick & mask_];
    if (head == kNone || chunks_[head].count == kChunkEntries) {
      const std::uint32_t fresh = take_chunk();
      if (fresh == kNone) {
        ++dropped_;
        return;
      }
      chunks_[fresh].next = head;
      chunks_[fresh].count = 0;
      head = fresh;
    }
    Chunk& chunk = chunks_[head];
    chunk.rows[chunk.count++] = row;
  }

  /// Takes the bucket of `tick` out; walk it with chunk() and give each chunk back with release().
  [[nodiscard]] std::uint32_t take(std::uint64_t tick) noexcept {
    std::uint32_t& head = heads_[tick & mask_];
    const std::uint32_t taken = head;
    head = kNone;
    return taken;
  }
  [[nodiscard]] const Chunk& chunk(std::uint32_t index) const noexcept { return chunks_[index]; }
  void release(std::uint32_t index) noexcept {
    chunks_[index].next = free_;
    free_ = index;
  }

  [[nodiscard]] std::uint64_t row_count(std::uint64_t tick) const noexcept {
    std::uint64_t rows = 0;
    for (std::uint32_t index = heads_[tick & mask_]; index != kNone; index = chunks_[index].next) {
      rows += chunks_[index].count;
    }
    return rows;
  }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  [[nodiscard]] std::uint32_t take_chunk() noexcept {
    if (free_ != kNone) {
      const std::uint32_t index = free_;
      free_ = chunks_[index].next;
      return index;
    }
    return used_ < capacity_ ? used_++ : kNone;
  }

  std::uint64_t mask_;
  std::vector<std::uint32_t> heads_;
  std::unique_ptr<Chunk[]> chunks_;  // left unwritten until used, so that the worst case costs address space only
  std::uint32_t capacity_;
  std::uint32_t used_ = 0;
  std::uint32_t free_ = kNone;
  std::uint64_t dropped_ = 0;
};

}  // namespace tectum
