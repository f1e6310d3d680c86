// Finds frames in a stream of bytes that may hold anything.
//
// Bytes that belong to no packet are skipped. The two ends of the wire differ in what they do next.
//
// The host (Status) gives up a packet with a wrong checksum byte by byte, so that a whole packet inside or right behind
// a damaged one is found as soon as its last byte is there: nothing waits for a time-out. A length that no expected
// packet can have is never waited for.
//
// A servo (Instruction) collects as many bytes as the length says, whatever they are, and drops them all when the
// checksum is wrong. A damaged length therefore swallows what comes behind it, up to 255 bytes, or until the line has
// been quiet for 100 ms (e-manual, "Byte to Byte Time"; clear() is for that).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/servo/packet.h"

namespace tectum::dynamixel {

enum class PacketKind : std::uint8_t { Instruction, Status };

enum class ParseResult : std::uint8_t {
  NeedMore,     // no frame in the bytes so far
  Whole,        // `out` holds one
  BadChecksum,  // `out.id` and `out.code` are those of a damaged frame; ask again, there may be more
};

struct ParserCounters {
  std::uint64_t frames = 0;
  std::uint64_t bad_checksums = 0;
  std::uint64_t skipped_bytes = 0;  // in no frame, those of damaged frames included
};

/// Not real-time safe by contract, but neither allocates nor throws.
class PacketParser {
 public:
  explicit PacketParser(PacketKind kind) noexcept : kind_(kind) {}

  /// Status frames only: from now on nothing but frames of this ID with this many parameters, or with none, which is
  /// how a servo refuses.
  void expect(std::uint8_t id, std::uint8_t parameter_count) noexcept;
  /// Forgets unfinished bytes.
  void clear() noexcept { begin_ = end_ = 0; }
  /// Takes what came. When its kCapacity is exceeded the oldest bytes are skipped; drain with next() after every push.
  void push(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] ParseResult next(Packet& out) noexcept;

  /// Bytes of a frame that is not complete yet.
  [[nodiscard]] std::size_t pending_bytes() const noexcept { return end_ - begin_; }
  [[nodiscard]] const ParserCounters& counters() const noexcept { return counters_; }

 private:
  static constexpr std::size_t kCapacity = 1024;  // more than three of the longest frames

  [[nodiscard]] bool is_plausible() const noexcept;
  void skip(std::size_t count) noexcept;

  PacketKind kind_;
  bool is_expecting_ = false;
  std::uint8_t expected_id_ = 0;
  std::uint8_t expected_count_ = 0;
  std::array<std::uint8_t, kCapacity> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  ParserCounters counters_;
};

}  // namespace tectum::dynamixel
