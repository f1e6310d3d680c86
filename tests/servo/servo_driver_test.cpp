// The driver's thread against the emulated bus behind a real terminal, in real time. Times are wide: the machine that
// runs this may be busy.
#include "drivers/servo/servo_driver.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "drivers/servo/ax12_emulator.h"
#include "drivers/servo/emulated_sketch.h"
#include "drivers/servo/latest_value.h"
#include "drivers/servo/pty_device.h"

using namespace tectum;

namespace {

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kSecond = 1000 * kMs;
constexpr std::uint32_t kAll = (1U << kJointCount) - 1;
constexpr std::size_t kLeftPan = static_cast<std::size_t>(Joint::LeftEyePan);

bool becomes(const std::function<bool()>& condition, TimeNs within_ns = 5 * kSecond) {
  for (const TimeNs end_ns = PtyDevice::now_ns() + within_ns; PtyDevice::now_ns() < end_ns;) {
    if (condition()) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

struct Bench {
  explicit Bench(TimeNs hush_ns = ServoDriverOptions{}.hush_ns) {
    for (std::uint8_t id = 1; id <= 6; ++id) {
      emulator.add_servo(id).set(ax12::kReturnDelayTime, 0, 0);
    }
    const auto link = std::filesystem::temp_directory_path() / ("tectum-driver-" + std::to_string(::getpid()));
    pty = PtyDevice::open(emulator, {.link_path = link.string()}, error);
    REQUIRE_MESSAGE(pty != nullptr, error);
    ServoDriverOptions options;
    options.reopen_every_ns = 50 * kMs;
    options.hush_ns = hush_ns;
    options.packets.bus.answer_margin_ns = 50 * kMs;
    options.packets.bus.gap_ns = 50 * kMs;
    driver = std::make_unique<ServoDriver>(options, serial_link(pty->path(), 1'000'000));
  }
  std::uint16_t peek(std::uint8_t id, const ax12::Register& row) {
    std::uint16_t value = 0;
    pty->with_device([&](TimeNs) { value = emulator.find(id)->get(row); });
    return value;
  }
  // What the loop does: takes what was measured, and sends goals.
  std::uint32_t turn(double left_pan_deg, bool torque_on = true) {
    ServoFeedback feedback;
    driver->read(PtyDevice::now_ns(), feedback);
    ServoCommand command;
    command.goal_deg[kLeftPan] = left_pan_deg;
    command.torque_on = torque_on;
    is_taken = driver->write(command);
    return feedback.fresh_mask;
  }
  bool was_told(const std::string& text) {
    for (const ServoEvent& event : driver->take_events()) {
      told += event.text + "\n";
    }
    return told.find(text) != std::string::npos;
  }

  std::string error;
  std::string told;
  bool is_taken = false;
  Ax12Emulator emulator;
  std::unique_ptr<PtyDevice> pty;
  std::unique_ptr<ServoDriver> driver;
};

}  // namespace

TEST_CASE("the newest value is taken, whole, and once") {
  LatestValue<std::array<int, 64>> box;
  std::array<int, 64> out{};
  CHECK_FALSE(box.take(out));
  std::thread writer([&] {
    for (int i = 1; i <= 200'000; ++i) {
      std::array<int, 64> value;
      value.fill(i);
      box.put(value);
    }
  });
  int last = 0;
  bool is_whole = true;
  bool is_ascending = true;
  while (last < 200'000) {
    if (box.take(out)) {
      is_whole = is_whole && out.front() == out.back();
      is_ascending = is_ascending && out.front() > last;
      last = out.front();
    }
  }
  writer.join();
  CHECK(is_whole);
  CHECK(is_ascending);
}

TEST_CASE("latencies are counted to ten microseconds") {
  LatencyHistogram histogram;
  CHECK(histogram.quantile_ns(0.99) == 0);
  for (int i = 0; i < 99; ++i) {
    histogram.add(55'000);
  }
  histogram.add(3 * kMs);
  CHECK(histogram.quantile_ns(0.5) == 60'000);
  CHECK(histogram.quantile_ns(0.99) == 60'000);
  CHECK(histogram.quantile_ns(0.999) == 3 * kMs);
  CHECK(histogram.longest_ns() == 3 * kMs);
}

TEST_CASE("the loop's goals reach the servos, and their angles the loop") {
  Bench bench;
  REQUIRE(bench.driver->wait_until_ready(5 * kSecond));
  CHECK(bench.turn(0) == kAll);
  ServoFeedback feedback;
  CHECK(becomes([&] {
    bench.driver->read(0, feedback);
    ServoCommand command;
    command.goal_deg[kLeftPan] = 20;
    return bench.driver->write(command) && std::abs(feedback.position_deg[kLeftPan] - 20) < 1;
  }));
  CHECK(feedback.measured_ns > 0);
  CHECK(bench.peek(3, ax12::kTorqueEnable) == 1);
  CHECK(bench.driver->command_latency().count() > 0);
  CHECK(bench.driver->report().wire.troubles() == 0);
}

TEST_CASE("between the loop's reading and its command no question is begun") {
  constexpr TimeNs kForever = 3600 * kSecond;
  Bench bench(kForever);
  REQUIRE(bench.driver->wait_until_ready(5 * kSecond));
  ServoFeedback feedback;
  const auto requests = [&] { return bench.driver->report().wire.requests; };
  const std::uint64_t before = requests();
  CHECK(becomes([&] { return requests() > before + 20; }));
  bench.driver->read(0, feedback);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // the question under way
  const std::uint64_t hushed = requests();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(requests() <= hushed + 1);
  CHECK(bench.driver->write(ServoCommand{}));
  CHECK(becomes([&] { return requests() > hushed + 20; }));
}

TEST_CASE("torque goes off on request and at the end") {
  Bench bench;
  REQUIRE(bench.driver->wait_until_ready(5 * kSecond));
  bench.turn(0);
  bench.turn(0);
  CHECK(becomes([&] { return bench.peek(3, ax12::kTorqueEnable) == 1; }));
  bench.turn(0, false);
  CHECK(becomes([&] { return bench.peek(3, ax12::kTorqueEnable) == 0; }));
  bench.turn(0);
  CHECK(becomes([&] { return bench.peek(3, ax12::kTorqueEnable) == 1; }));
  bench.driver->stop();
  for (std::uint8_t id = 1; id <= 6; ++id) {
    CHECK(bench.peek(id, ax12::kTorqueEnable) == 0);
  }
}

TEST_CASE("a port that vanishes is told, and everything goes on when it is back") {
  Bench bench;
  REQUIRE(bench.driver->wait_until_ready(5 * kSecond));
  bench.turn(0);
  bench.turn(10);
  bench.pty->unplug();
  CHECK(becomes([&] { return bench.was_told("the port is gone"); }));
  CHECK(bench.turn(10) == 0);
  CHECK_FALSE(bench.is_taken);
  REQUIRE(bench.pty->plug_in(bench.error));
  CHECK(becomes([&] { return bench.was_told("the port is back"); }));
  CHECK(becomes([&] { return bench.turn(15) != 0; }));
  CHECK(becomes([&] {
    bench.turn(15);
    return bench.peek(3, ax12::kGoalPosition) == 563;
  }));
  CHECK(bench.driver->report().reconnections == 1);
}

TEST_CASE("a lost servo is not fresh, gets no old goal when it returns, and new ones after it was seen") {
  Bench bench;
  REQUIRE(bench.driver->wait_until_ready(5 * kSecond));
  bench.turn(0);
  bench.turn(10);
  bench.pty->with_device([&](TimeNs now_ns) { bench.emulator.pull_plug(3, now_ns); });
  CHECK(becomes([&] { return bench.was_told("servo 3 (left_eye_pan) has not answered"); }));
  // From now on the loop only writes: it has not seen the servo come back.
  ServoFeedback feedback;
  bench.driver->read(0, feedback);
  CHECK((feedback.fresh_mask >> kLeftPan & 1U) == 0);
  bench.pty->with_device([&](TimeNs now_ns) { bench.emulator.plug_in(3, now_ns); });
  CHECK(becomes([&] { return bench.was_told("servo 3 (left_eye_pan) answers again"); }));
  ServoCommand command;
  command.goal_deg[kLeftPan] = 30;
  CHECK(bench.driver->write(command));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(bench.peek(3, ax12::kTorqueEnable) == 0);
  CHECK(becomes([&] {
    bench.turn(30);
    return bench.peek(3, ax12::kTorqueEnable) == 1;
  }));
}

TEST_CASE("without a port commands are refused, and the reason is told once") {
  ServoDriverOptions options;
  options.reopen_every_ns = 10 * kMs;
  ServoDriver driver(options, serial_link("/dev/tectum-no-such-port", 1'000'000));
  CHECK_FALSE(driver.wait_until_ready(100 * kMs));
  CHECK_FALSE(driver.write({}));
  const auto events = driver.take_events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].text == "/dev/tectum-no-such-port: no such device; is the adapter plugged in?");
}

TEST_CASE("the head of 2020 moves through its own program") {
  EmulatedSketch head;
  std::string error;
  auto pty = PtyDevice::open(head, {}, error);
  REQUIRE_MESSAGE(pty != nullptr, error);
  ServoDriverOptions options;
  options.kind = ServoLinkKind::ArbotixAscii;
  ServoDriver driver(options, serial_link(pty->path(), usual_baud(options.kind)));
  REQUIRE(driver.wait_until_ready(5 * kSecond));
  ServoFeedback feedback;
  CHECK(becomes([&] {
    driver.read(0, feedback);
    ServoCommand command;
    command.goal_deg[kLeftPan] = 20;
    return driver.write(command) && std::abs(feedback.position_deg[kLeftPan] - 20) < 1;
  }));
  CHECK_FALSE(head.is_hung());
}
