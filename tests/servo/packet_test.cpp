#include "drivers/servo/packet.h"

#include <doctest/doctest.h>

#include <vector>

using namespace tectum;
using dynamixel::PacketBytes;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes of(const PacketBytes& frame) { return {frame.bytes().begin(), frame.bytes().end()}; }

}  // namespace

// The examples of the e-manual's page on Protocol 1.0, byte for byte.
TEST_CASE("instruction packets are those of the manual") {
  struct Case {
    const char* name;
    PacketBytes frame;
    Bytes expected;
  };
  const Case cases[] = {
      {"ping", dynamixel::encode_ping(1), {0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB}},
      {"read temperature", dynamixel::encode_read(1, 43, 1), {0xFF, 0xFF, 0x01, 0x04, 0x02, 0x2B, 0x01, 0xCC}},
      {"write",
       dynamixel::encode_write(1, 12, Bytes{100, 170}),
       {0xFF, 0xFF, 0x01, 0x05, 0x03, 0x0C, 0x64, 0xAA, 0xDC}},
      {"write id by broadcast",
       dynamixel::encode_write(dynamixel::kBroadcastId, 3, Bytes{1}),
       {0xFF, 0xFF, 0xFE, 0x04, 0x03, 0x03, 0x01, 0xF6}},
      {"reg write goal 500",
       dynamixel::encode_reg_write(1, 30, Bytes{0xF4, 0x01}),
       {0xFF, 0xFF, 0x01, 0x05, 0x04, 0x1E, 0xF4, 0x01, 0xE2}},
      {"action", dynamixel::encode_action(), {0xFF, 0xFF, 0xFE, 0x02, 0x05, 0xFA}},
      {"factory reset", dynamixel::encode_factory_reset(0), {0xFF, 0xFF, 0x00, 0x02, 0x06, 0xF7}},
      {"sync write",
       dynamixel::encode_sync_write(30, 4, Bytes{0, 1}, Bytes{0x10, 0x00, 0x50, 0x01, 0x20, 0x02, 0x60, 0x03}),
       {0xFF, 0xFF, 0xFE, 0x0E, 0x83, 0x1E, 0x04, 0x00, 0x10, 0x00, 0x50, 0x01, 0x01, 0x20, 0x02, 0x60, 0x03, 0x67}},
      {"bulk read",
       dynamixel::encode_bulk_read(std::vector<dynamixel::BulkReadItem>{{1, 0x1E, 2}, {2, 0x24, 2}}),
       {0xFF, 0xFF, 0xFE, 0x09, 0x92, 0x00, 0x02, 0x01, 0x1E, 0x02, 0x02, 0x24, 0x1D}},
  };
  for (const Case& c : cases) {
    CAPTURE(c.name);
    CHECK(of(c.frame) == c.expected);
  }
}

TEST_CASE("status packets are those of the manual") {
  CHECK(of(dynamixel::encode_status(1, 0, {})) == Bytes{0xFF, 0xFF, 0x01, 0x02, 0x00, 0xFC});
  CHECK(of(dynamixel::encode_status(1, 0, Bytes{0x20})) == Bytes{0xFF, 0xFF, 0x01, 0x03, 0x00, 0x20, 0xDB});
  const std::uint8_t overload_and_heat = dynamixel::kOverloadError | dynamixel::kHeatError;
  CHECK(of(dynamixel::encode_status(1, overload_and_heat, {})) == Bytes{0xFF, 0xFF, 0x01, 0x02, 0x24, 0xD8});
}

// The ArbotiX firmware's own instruction: five bytes of overhead, then the servos.
TEST_CASE("sync read names the address, the size and the servos") {
  const Bytes frame = of(dynamixel::encode_sync_read(36, 2, Bytes{1, 2, 3}));
  CHECK(Bytes(frame.begin(), frame.end() - 1) == Bytes{0xFF, 0xFF, 0xFE, 0x07, 0x84, 36, 2, 1, 2, 3});
}

TEST_CASE("every error bit has a name and its own place") {
  const std::uint8_t bits[] = {dynamixel::kVoltageError,    dynamixel::kAngleError,    dynamixel::kHeatError,
                               dynamixel::kRangeError,      dynamixel::kChecksumError, dynamixel::kOverloadError,
                               dynamixel::kInstructionError};
  for (std::size_t i = 0; i < std::size(bits); ++i) {
    CHECK(bits[i] == (1U << i));
    CHECK(dynamixel::kErrorBitNames[i] != nullptr);
  }
  CHECK(dynamixel::kErrorBitNames.size() == std::size(bits));
}

TEST_CASE("words are little-endian") {
  CHECK(dynamixel::word(0xF4, 0x01) == 500);
  CHECK(dynamixel::bytes_of(500) == std::array<std::uint8_t, 2>{0xF4, 0x01});
}
