// The emulated bus behind a real terminal: driver, kernel and bus in the loop, in real time.
#include "drivers/servo/pty_device.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <vector>

#include "drivers/servo/ax12_bus.h"
#include "drivers/servo/ax12_emulator.h"
#include "drivers/servo/serial_port.h"

using namespace tectum;

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr TimeNs kMs = 1'000'000;

// A margin that a busy machine keeps; a time-out here is a failure of the test, not of the driver.
const BusOptions kPatient{.answer_margin_ns = 500 * kMs, .gap_ns = 500 * kMs};

std::string fresh_path(const char* name) {
  return (std::filesystem::temp_directory_path() / (std::string(name) + std::to_string(::getpid()))).string();
}

struct Bench {
  explicit Bench(const std::string& link_path = "") {
    emulator.add_servo(1);
    emulator.add_servo(2);
    device = PtyDevice::open(emulator, {.link_path = link_path}, error);
    REQUIRE_MESSAGE(device != nullptr, error);
  }
  std::unique_ptr<SerialPort> open_port(std::uint32_t baud = 1'000'000) {
    return SerialPort::open(device->path(), baud, error);
  }

  std::string error;
  Ax12Emulator emulator;
  std::unique_ptr<PtyDevice> device;
};

}  // namespace

TEST_CASE("servos answer through a terminal") {
  Bench bench;
  const auto port = bench.open_port();
  REQUIRE_MESSAGE(port != nullptr, bench.error);
  Ax12Bus bus(*port, kPatient);
  CHECK(bus.ping(1).is_ok());
  CHECK(bus.write(2, ax12::kGoalPosition, 600).is_ok());
  std::uint16_t goal = 0;
  for (int i = 0; i < 200; ++i) {
    REQUIRE(bus.read(2, ax12::kGoalPosition, goal).is_ok());
    CHECK(goal == 600);
  }
  CHECK(bus.statistics().troubles() == 0);
  CHECK_FALSE(port->is_low_latency());  // a pseudo-terminal has no such thing, and says so
}

TEST_CASE("the terminal's baud rate is the line's: a servo hears only its own") {
  Bench bench;
  BusOptions options = kPatient;
  options.attempts = 1;
  options.answer_margin_ns = 50 * kMs;
  for (const std::uint32_t baud : {9600U, 57600U, 115200U, 250000U, 1'000'000U}) {
    CAPTURE(baud);
    bench.device->with_device([&](TimeNs now_ns) {
      bench.emulator.find(2)->set(ax12::kBaudRate, static_cast<std::uint16_t>(2e6 / baud + 0.5 - 1), now_ns);
    });
    const auto port = bench.open_port(baud);
    REQUIRE_MESSAGE(port != nullptr, bench.error);
    options.baud = baud;
    Ax12Bus bus(*port, options);
    CHECK(bus.ping(2).is_ok());
    CHECK(bus.ping(1).is_ok() == (baud == 1'000'000));
  }
}

TEST_CASE("a port that is pulled is gone, and one that comes back works again under the same name") {
  const std::string link = fresh_path("tectum-pty-");
  Bench bench(link);
  CHECK(bench.device->path() == link);
  auto port = bench.open_port();
  REQUIRE_MESSAGE(port != nullptr, bench.error);
  {
    Ax12Bus bus(*port, kPatient);
    CHECK(bus.ping(1).is_ok());
    bench.device->unplug();
    CHECK(bus.ping(1).status == BusStatus::LinkGone);
  }
  port.reset();
  CHECK(bench.open_port() == nullptr);
  CHECK(bench.error == link + ": no such device; is the adapter plugged in?");
  REQUIRE(bench.device->plug_in(bench.error));
  port = bench.open_port();
  REQUIRE_MESSAGE(port != nullptr, bench.error);
  Ax12Bus bus(*port, kPatient);
  CHECK(bus.ping(1).is_ok());
}

TEST_CASE("one program at a time uses a port") {
  Bench bench;
  const auto port = bench.open_port();
  REQUIRE(port != nullptr);
  CHECK(bench.open_port() == nullptr);
  CHECK(bench.error == bench.device->path() + ": another program uses it");
}

TEST_CASE("what is no serial device is refused") {
  std::string error;
  CHECK(SerialPort::open("/dev/null", 1'000'000, error) == nullptr);
  CHECK(error == "/dev/null: not a serial device");
}

TEST_CASE("a read returns at its deadline when nothing comes") {
  Bench bench;
  const auto port = bench.open_port();
  REQUIRE(port != nullptr);
  Bytes bytes(8);
  std::size_t count = 0;
  const TimeNs deadline_ns = port->now_ns() + 20 * kMs;
  CHECK(port->read(bytes, count, deadline_ns) == LinkRead::TimedOut);
  CHECK(port->now_ns() >= deadline_ns);
}

// A terminal that has hung up is ready to be read for ever, and has nothing: a loop that only asks whether it is ready
// spins.
TEST_CASE("a port that is pulled while a read waits is gone at once") {
  Bench bench;
  const auto port = bench.open_port();
  REQUIRE(port != nullptr);
  std::thread puller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    bench.device->unplug();
  });
  Bytes bytes(8);
  std::size_t count = 0;
  CHECK(port->read(bytes, count, port->now_ns() + 20'000 * kMs) == LinkRead::Gone);
  puller.join();
}

TEST_CASE("an existing file is not overwritten by the terminal's link") {
  const std::string path = fresh_path("tectum-file-");
  std::fclose(std::fopen(path.c_str(), "w"));
  Ax12Emulator emulator;
  std::string error;
  CHECK(PtyDevice::open(emulator, {.link_path = path}, error) == nullptr);
  CHECK(error == path + ": File exists");
  CHECK(std::filesystem::is_regular_file(path));
  std::filesystem::remove(path);
}
