#include "drivers/servo/packet_parser.h"

#include <doctest/doctest.h>

#include <random>
#include <tuple>
#include <vector>

using namespace tectum::dynamixel;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes of(const PacketBytes& frame) { return {frame.bytes().begin(), frame.bytes().end()}; }

void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

struct Found {
  std::vector<Packet> frames;
  int bad_checksums = 0;
};

void drain(PacketParser& parser, Found& found) {
  Packet frame;
  for (;;) {
    switch (parser.next(frame)) {
      case ParseResult::NeedMore:
        return;
      case ParseResult::Whole:
        found.frames.push_back(frame);
        break;
      case ParseResult::BadChecksum:
        ++found.bad_checksums;
        break;
    }
  }
}

Found parse(PacketParser& parser, const Bytes& bytes) {
  Found found;
  parser.push(bytes);
  drain(parser, found);
  return found;
}

Found parse_status(const Bytes& bytes) {
  PacketParser parser(PacketKind::Status);
  return parse(parser, bytes);
}

const Bytes kAnswer = of(encode_status(1, 0, Bytes{0x20, 0x02}));

}  // namespace

TEST_CASE("a frame that comes byte by byte is found at its last byte") {
  PacketParser parser(PacketKind::Status);
  Found found;
  for (std::size_t i = 0; i < kAnswer.size(); ++i) {
    CHECK(found.frames.empty());
    parser.push(Bytes{kAnswer[i]});
    drain(parser, found);
  }
  REQUIRE(found.frames.size() == 1);
  CHECK(found.frames[0].id == 1);
  CHECK(word(found.frames[0].parameters[0], found.frames[0].parameters[1]) == 544);
  CHECK(parser.pending_bytes() == 0);
}

TEST_CASE("garbage before a frame, lone header bytes included, is skipped") {
  for (const Bytes& garbage : {Bytes{0x00}, Bytes{0xFF}, Bytes{0xFF, 0xFF}, Bytes{0xFF, 0x01, 0xFF},
                               Bytes{0xFF, 0xFF, 0x00, 0x01}, Bytes{0x12, 0x34, 0x56}}) {
    CAPTURE(garbage);
    Bytes stream = garbage;
    append(stream, kAnswer);
    PacketParser parser(PacketKind::Status);
    const Found found = parse(parser, stream);
    REQUIRE(found.frames.size() == 1);
    CHECK(parser.counters().skipped_bytes == garbage.size());
  }
}

TEST_CASE("a frame right behind one with a wrong checksum is found") {
  Bytes stream = kAnswer;
  stream[7] ^= 0x10;
  append(stream, kAnswer);
  const Found found = parse_status(stream);
  CHECK(found.bad_checksums == 1);
  CHECK(found.frames.size() == 1);
}

// The lost byte makes the frame swallow the next one's first byte, which is given back.
TEST_CASE("a frame right behind one that lost any of its bytes is found without more bytes") {
  for (std::size_t lost = 0; lost < kAnswer.size(); ++lost) {
    CAPTURE(lost);
    Bytes stream = kAnswer;
    stream.erase(stream.begin() + static_cast<std::ptrdiff_t>(lost));
    append(stream, kAnswer);
    PacketParser parser(PacketKind::Status);
    parser.expect(1, 2);
    CHECK(parse(parser, stream).frames.size() == 1);
    CHECK(parser.pending_bytes() == 0);
  }
}

TEST_CASE("a length that the expected frame cannot have is not waited for") {
  Bytes stream = kAnswer;
  stream[kLengthAt] = 0xF0;  // would swallow 240 bytes
  append(stream, kAnswer);
  PacketParser parser(PacketKind::Status);
  parser.expect(1, 2);
  CHECK(parse(parser, stream).frames.size() == 1);
}

TEST_CASE("an answer of another servo, or of another size, is not the expected one") {
  PacketParser parser(PacketKind::Status);
  parser.expect(1, 2);
  CHECK(parse(parser, of(encode_status(2, 0, Bytes{0, 0}))).frames.empty());
  CHECK(parse(parser, of(encode_status(1, 0, Bytes{0, 0, 0}))).frames.empty());
  CHECK(parse(parser, kAnswer).frames.size() == 1);
  CHECK(parse(parser, of(encode_status(1, kRangeError, {}))).frames.size() == 1);  // a refusal has no parameters
}

// As a servo does; the bus has to cope with it.
TEST_CASE("a servo collects what the length says, drops it all, and hears the packet behind it") {
  Bytes stream = of(encode_ping(1));
  stream[kLengthAt] = 2 + 6;  // swallows the next packet
  append(stream, of(encode_ping(2)));
  append(stream, of(encode_ping(3)));
  PacketParser parser(PacketKind::Instruction);
  const Found found = parse(parser, stream);
  CHECK(found.bad_checksums == 1);
  REQUIRE(found.frames.size() == 1);
  CHECK(found.frames[0].id == 3);
}

TEST_CASE("an instruction with parameters that it cannot have is told from one that can") {
  Packet packet;
  for (const auto& [code, fits, does_not] :
       {std::tuple{Instruction::Ping, 0, 1}, std::tuple{Instruction::Read, 2, 1}, std::tuple{Instruction::Write, 2, 1},
        std::tuple{Instruction::SyncWrite, 3, 2}, std::tuple{Instruction::BulkRead, 4, 5}}) {
    packet.code = static_cast<std::uint8_t>(code);
    packet.parameter_count = static_cast<std::uint8_t>(fits);
    CHECK(has_fitting_length(packet));
    packet.parameter_count = static_cast<std::uint8_t>(does_not);
    CHECK_FALSE(has_fitting_length(packet));
  }
}

TEST_CASE("every frame that is encoded is decoded to the same") {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> byte(0, 255);
  PacketParser parser(PacketKind::Status);
  for (std::size_t count = 0; count <= kMaxParameters; ++count) {
    Bytes parameters(count);
    for (std::uint8_t& parameter : parameters) {
      parameter = static_cast<std::uint8_t>(byte(random));
    }
    const auto id = static_cast<std::uint8_t>(byte(random) % (kHighestId + 1));
    const auto bits = static_cast<std::uint8_t>(byte(random) & 0x7F);
    const Found found = parse(parser, of(encode_status(id, bits, parameters)));
    REQUIRE(found.frames.size() == 1);
    CHECK(found.frames[0].id == id);
    CHECK(found.frames[0].code == bits);
    const auto payload = found.frames[0].payload();
    CHECK(Bytes(payload.begin(), payload.end()) == parameters);
  }
}

TEST_CASE("random garbage never stops the parser from finding the frame behind it") {
  constexpr unsigned kSeed = 20;
  MESSAGE("seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int> byte(0, 255);
  std::uniform_int_distribution<int> length(0, 40);
  std::bernoulli_distribution is_header(0.3);  // garbage that looks like headers
  int garbage_frames = 0;
  for (int round = 0; round < 20000; ++round) {
    PacketParser parser(PacketKind::Status);
    parser.expect(1, 2);
    Bytes stream;
    for (int n = length(random); n > 0; --n) {
      stream.push_back(is_header(random) ? kHeader : static_cast<std::uint8_t>(byte(random)));
    }
    append(stream, kAnswer);
    append(stream, kAnswer);  // garbage may end in a header that swallows the first; never the second
    const Found found = parse(parser, stream);
    garbage_frames += found.frames.size() > 2 ? 1 : 0;
    REQUIRE(found.frames.size() >= 1);
    const auto payload = found.frames.back().payload();
    REQUIRE(Bytes(payload.begin(), payload.end()) == Bytes{0x20, 0x02});
  }
  CHECK(garbage_frames < 5);
}

TEST_CASE("more bytes than the parser can hold cost the oldest, and no more") {
  PacketParser parser(PacketKind::Instruction);
  Bytes flood(5000, 0x00);
  append(flood, of(encode_ping(7)));
  const Found found = parse(parser, flood);
  REQUIRE(found.frames.size() == 1);
  CHECK(found.frames[0].id == 7);
  CHECK(parser.counters().skipped_bytes == 5000);
}
