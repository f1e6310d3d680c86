#include "drivers/servo/packet_parser.h"

#include <algorithm>

namespace tectum::dynamixel {
namespace {

constexpr std::size_t kMinLength = kLengthOverhead;

// Whether an instruction can have this LEN. What no servo knows may have any: it is answered with an error.
bool can_have_length(std::uint8_t instruction, std::size_t length) noexcept {
  switch (static_cast<Instruction>(instruction)) {
    case Instruction::Ping:
    case Instruction::Action:
    case Instruction::FactoryReset:
      return length == kLengthOverhead;
    case Instruction::Read:
      return length == kLengthOverhead + 2;
    case Instruction::Write:
    case Instruction::RegWrite:
      return length >= kLengthOverhead + 2;
    case Instruction::SyncWrite:
    case Instruction::SyncRead:
      return length >= kLengthOverhead + 3;
    case Instruction::BulkRead:
      return length >= kLengthOverhead + 4 && length % 3 == 0;
  }
  return true;
}

}  // namespace

void PacketParser::expect(std::uint8_t id, std::uint8_t parameter_count) noexcept {
  is_expecting_ = true;
  expected_id_ = id;
  expected_count_ = parameter_count;
}

void PacketParser::skip(std::size_t count) noexcept {
  begin_ += count;
  counters_.skipped_bytes += count;
}

void PacketParser::push(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() > kCapacity) {
    counters_.skipped_bytes += bytes.size() - kCapacity;
    bytes = bytes.last(kCapacity);
  }
  if (end_ + bytes.size() > kCapacity) {
    const std::size_t kept = end_ - begin_;
    const std::size_t room = kCapacity - bytes.size();
    if (kept > room) {
      skip(kept - room);
    }
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  std::copy(bytes.begin(), bytes.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
  end_ += bytes.size();
}

bool PacketParser::is_plausible() const noexcept {
  const std::uint8_t* at = buffer_.data() + begin_;
  const std::size_t have = end_ - begin_;
  if (have > 0 && at[0] != kHeader) {
    return false;
  }
  if (have > 1 && at[1] != kHeader) {
    return false;
  }
  if (have > kIdAt && (at[kIdAt] == kHeader || (is_expecting_ && at[kIdAt] != expected_id_))) {
    return false;  // FF is no ID: a third FF moves the header along by one
  }
  if (have > kLengthAt) {
    const std::size_t length = at[kLengthAt];
    if (length < kMinLength) {
      return false;
    }
    if (is_expecting_ && length != kMinLength && length != kLengthOverhead + expected_count_) {
      return false;
    }
  }
  if (have > kCodeAt) {
    if (kind_ == PacketKind::Status) {
      return (at[kCodeAt] & 0x80U) == 0;  // bit 7 of ERR is always 0
    }
    return can_have_length(at[kCodeAt], at[kLengthAt]);
  }
  return true;
}

ParseResult PacketParser::next(Packet& out) noexcept {
  while (begin_ < end_) {
    if (!is_plausible()) {
      skip(1);
      continue;
    }
    const std::size_t have = end_ - begin_;
    if (have <= kLengthAt) {
      return ParseResult::NeedMore;
    }
    const std::size_t size = kPacketOverhead - kLengthOverhead + buffer_[begin_ + kLengthAt];
    if (have < size) {
      return ParseResult::NeedMore;
    }
    const std::span<const std::uint8_t> frame = std::span(buffer_).subspan(begin_, size);
    out.id = frame[kIdAt];
    out.code = frame[kCodeAt];
    if (checksum(frame.subspan(kIdAt, size - kIdAt - 1)) != frame.back()) {
      ++counters_.bad_checksums;
      skip(1);
      return ParseResult::BadChecksum;
    }
    out.parameter_count = static_cast<std::uint8_t>(size - kPacketOverhead);
    std::copy_n(frame.begin() + kCodeAt + 1, out.parameter_count, out.parameters.begin());
    begin_ += size;
    ++counters_.frames;
    return ParseResult::Whole;
  }
  return ParseResult::NeedMore;
}

}  // namespace tectum::dynamixel
