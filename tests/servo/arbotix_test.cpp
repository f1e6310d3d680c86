#include <doctest/doctest.h>

#include <vector>

#include "drivers/servo/ax12_bus.h"
#include "drivers/servo/emulated_arbotix.h"
#include "drivers/servo/emulated_link.h"

using namespace tectum;

namespace {

using Bytes = std::vector<std::uint8_t>;

struct Bench {
  explicit Bench(BusAdapter adapter = BusAdapter::ArbotixRos)
      : bus(link, {.baud = EmulatedArbotix::kHostBaud, .adapter = adapter}) {}
  Ax12Emulator emulator;
  EmulatedServo& one = emulator.add_servo(1);
  EmulatedServo& two = emulator.add_servo(2);
  EmulatedArbotix board{emulator};
  EmulatedLink link{board};
  Ax12Bus bus;
};

}  // namespace

// A driver that does not know the board would wait for answers that never come.
TEST_CASE("the board swallows a ping") {
  Bench bench(BusAdapter::Transparent);
  CHECK(bench.bus.ping(1).status == BusStatus::NoAnswer);
}

TEST_CASE("a ping through the board is a read of the ID") {
  Bench bench;
  CHECK(bench.bus.ping(1).is_ok());
  CHECK(bench.bus.ping(3).status == BusStatus::NoAnswer);
  CHECK(bench.bus.scan(0, 4, {}) == Bytes{1, 2});
}

TEST_CASE("a write of several registers reaches the servo one by one") {
  Bench bench;
  CHECK(bench.bus.write(1, 30, Bytes{0x00, 0x01, 0x64, 0x00}).is_ok());
  CHECK(bench.one.get(ax12::kGoalPosition) == 256);
  CHECK(bench.one.get(ax12::kMovingSpeed) == 100);
}

TEST_CASE("the board hides that a servo refuses") {
  Bench bench;
  CHECK(bench.bus.write(1, ax12::kGoalPosition, 1024).is_ok());
  CHECK(bench.one.get(ax12::kGoalPosition) == 512);
}

TEST_CASE("a sync write passes in spite of the byte that leaks behind it") {
  Bench bench;
  CHECK(bench.bus.sync_write(30, 2, Bytes{1, 2}, Bytes{0x00, 0x01, 0x00, 0x02}).is_ok());
  std::uint16_t goal = 0;
  CHECK(bench.bus.read(2, ax12::kGoalPosition, goal).is_ok());
  CHECK(goal == 512);
  CHECK(bench.bus.read(1, ax12::kGoalPosition, goal).is_ok());
  CHECK(goal == 256);
}

TEST_CASE("a sync read gives every servo's bytes, and FF for one that is silent") {
  Bench bench;
  Bytes out(6);
  CHECK(bench.bus.sync_read(36, 2, Bytes{1, 9, 2}, out).is_ok());
  CHECK(out == Bytes{0x00, 0x02, 0xFF, 0xFF, 0x00, 0x02});
}

TEST_CASE("what the board does not pass is not tried") {
  Bench bench;
  CHECK(bench.bus.reg_write(1, 30, Bytes{0, 1}).status == BusStatus::Unsupported);
  CHECK(bench.bus.action().status == BusStatus::Unsupported);
  CHECK(bench.bus.factory_reset(1).status == BusStatus::Unsupported);
  Bytes too_much(27);
  CHECK(bench.bus.read(1, 0, too_much).status == BusStatus::Unsupported);
}

TEST_CASE("the board itself is model 300 at ID 253") {
  Bench bench;
  std::uint16_t model = 0;
  CHECK(bench.bus.read(253, *ax12::find_register("model_number"), model).is_ok());
  CHECK(model == 300);
}
