// A synchronous client of a bus of AX-12As: one question, one answer, with retries inside a budget.
//
// How long an answer is waited for follows from the baud rate, its size and the servo's return delay, plus the margin
// that the host needs. Once an answer has begun, a silence longer than `gap` ends it; gaps of 130 us are normal
// (Xevel). A damaged answer is asked for again as soon as its last byte is there.
//
// An answer does not say what was asked. One that comes late could be taken for the next answer of the same servo and
// size; when that may happen the line is first listened to until it is quiet.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "drivers/servo/ax12_registers.h"
#include "drivers/servo/byte_link.h"
#include "drivers/servo/packet_parser.h"

namespace tectum {

/// What stands between the host and the bus.
enum class BusAdapter : std::uint8_t {
  Transparent,  // U2D2, USB2Dynamixel, USB2AX: every byte passes
  ArbotixRos,   // ArbotiX-M with the `ros` firmware: see drivers/README.md for what it does not pass
};

struct BusOptions {
  std::uint32_t baud = 1'000'000;  // of the host's end of the line
  BusAdapter adapter = BusAdapter::Transparent;
  int attempts = 3;
  TimeNs answer_margin_ns = 3'000'000;  // USB frames of 1 ms, and the kernel
  TimeNs gap_ns = 2'000'000;
  /// Asked before another attempt: true gives the question up, because something more urgent waits. May be empty.
  std::function<bool()> gives_way = {};
};

enum class BusStatus : std::uint8_t {
  Ok,
  NoAnswer,     // not one byte in any attempt
  Damaged,      // answers came, none of them whole
  Refused,      // the servo understood and did not: see the error bits
  Unsupported,  // not through this adapter
  LinkGone,
};
[[nodiscard]] const char* describe(BusStatus status) noexcept;

struct BusAnswer {
  BusStatus status = BusStatus::NoAnswer;
  std::uint8_t error_bits = 0;  // of the last whole answer
  [[nodiscard]] bool is_ok() const noexcept { return status == BusStatus::Ok; }
};

struct BusStatistics {
  std::uint64_t requests = 0;  // with an answer to come, retries not counted
  std::uint64_t retries = 0;
  std::uint64_t failures = 0;   // requests that used up their attempts
  std::uint64_t given_way = 0;  // requests given up after a bad attempt for something more urgent
  std::uint64_t time_outs = 0;
  std::uint64_t broken_off = 0;  // answers that began and did not end
  std::uint64_t bad_checksums = 0;
  std::uint64_t skipped_bytes = 0;
  std::uint64_t reported_checksums = 0;  // the servo says that our packet came damaged
  std::uint64_t broadcasts = 0;
  /// Signs that the wire is not clean.
  [[nodiscard]] std::uint64_t troubles() const noexcept {
    return time_outs + broken_off + bad_checksums + skipped_bytes + reported_checksums;
  }
};

class Ax12Bus {
 public:
  /// `link` outlives it.
  explicit Ax12Bus(ByteLink& link, const BusOptions& options = {}) noexcept;

  [[nodiscard]] BusAnswer ping(std::uint8_t id) noexcept;
  /// Bytes from `address` on, as many as `out` holds.
  [[nodiscard]] BusAnswer read(std::uint8_t id, std::uint8_t address, std::span<std::uint8_t> out) noexcept;
  [[nodiscard]] BusAnswer read(std::uint8_t id, const ax12::Register& row, std::uint16_t& value) noexcept;
  [[nodiscard]] BusAnswer write(std::uint8_t id, std::uint8_t address, std::span<const std::uint8_t> data) noexcept;
  [[nodiscard]] BusAnswer write(std::uint8_t id, const ax12::Register& row, std::uint16_t value) noexcept;
  [[nodiscard]] BusAnswer reg_write(std::uint8_t id, std::uint8_t address, std::span<const std::uint8_t> data) noexcept;
  [[nodiscard]] BusAnswer factory_reset(std::uint8_t id) noexcept;

  // To all at once. Nobody answers, so that Ok says that the bytes were sent.
  [[nodiscard]] BusAnswer action() noexcept;
  [[nodiscard]] BusAnswer sync_write(std::uint8_t address, std::uint8_t size_each, std::span<const std::uint8_t> ids,
                                     std::span<const std::uint8_t> data) noexcept;

  /// ArbotiX only: the same bytes of several servos in one answer. A servo that does not answer gives FF bytes.
  [[nodiscard]] BusAnswer sync_read(std::uint8_t address, std::uint8_t size_each, std::span<const std::uint8_t> ids,
                                    std::span<std::uint8_t> out) noexcept;

  /// The IDs in [first, last] that answer. `progress` is called with each ID before it is asked; may be empty. When
  /// nobody answers, or somebody so late that others may have been too late, the silent IDs are asked once more and
  /// waited for 20 ms each: a busy host may take that long to hand an answer over.
  [[nodiscard]] std::vector<std::uint8_t> scan(std::uint8_t first, std::uint8_t last,
                                               const std::function<void(std::uint8_t)>& progress);

  /// A servo whose status return level is below 2 does not answer writes. 2 until told.
  void set_return_level(std::uint8_t id, std::uint8_t level) noexcept { return_level_[id] = level; }
  void set_return_delay(std::uint8_t id, TimeNs delay_ns) noexcept { return_delay_ns_[id] = delay_ns; }

  [[nodiscard]] const BusStatistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] ByteLink& link() noexcept { return link_; }
  [[nodiscard]] const BusOptions& options() const noexcept { return options_; }

 private:
  struct Question {
    const dynamixel::PacketBytes& frame;
    std::uint8_t id;
    std::uint8_t address;
    std::uint8_t answer_count;  // parameters
    TimeNs extra_ns = 0;        // that the servo or the adapter needs on top
  };
  enum class Outcome : std::uint8_t { Whole, Damaged, Silence, LinkGone };

  [[nodiscard]] BusAnswer ask(const Question& question, int attempts, std::span<std::uint8_t> out) noexcept;
  [[nodiscard]] Outcome listen(const Question& question, dynamixel::Packet& answer) noexcept;
  void wake_servos(std::uint8_t id) noexcept;
  [[nodiscard]] bool write_to_link(const dynamixel::PacketBytes& frame) noexcept;
  [[nodiscard]] BusAnswer send_only(const dynamixel::PacketBytes& frame) noexcept;
  [[nodiscard]] BusAnswer write_frame(const dynamixel::PacketBytes& frame, std::uint8_t id, std::uint8_t address,
                                      std::size_t size) noexcept;
  [[nodiscard]] BusAnswer write_in_words(std::uint8_t id, std::uint8_t address,
                                         std::span<const std::uint8_t> data) noexcept;
  void let_late_answers_pass(const Question& question) noexcept;
  [[nodiscard]] TimeNs wire_ns(std::size_t bytes) const noexcept;
  void collect_parser_counts() noexcept;

  ByteLink& link_;
  BusOptions options_;
  dynamixel::PacketParser parser_{dynamixel::PacketKind::Status};
  dynamixel::ParserCounters counted_;
  std::array<std::uint8_t, 256> return_level_;
  std::array<TimeNs, 256> return_delay_ns_;
  std::array<bool, 256> has_answered_{};
  BusStatistics statistics_;
  TimeNs sent_ns_ = 0;  // when the last byte will have left
  bool may_answer_late_ = false;
  std::uint8_t last_id_ = 0, last_address_ = 0, last_count_ = 0;
};

}  // namespace tectum
