#include "drivers/servo/packet_parser.h"

#include <algorithm>

namespace tectum::dynamixel {
namespace {

constexpr std::size_t kMinLength = kLengthOverhead;

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
    return kind_ == PacketKind::Instruction || (at[kCodeAt] & 0x80U) == 0;  // bit 7 of ERR is always 0
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
      skip(kind_ == PacketKind::Status ? 1 : size);
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
