// The whole story of six servos, in virtual time: found, moved, measured, lost, overloaded, revived.
#include "drivers/servo/packet_exchange.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "drivers/servo/ax12_emulator.h"
#include "drivers/servo/emulated_arbotix.h"
#include "drivers/servo/emulated_link.h"

using namespace tectum;

namespace {

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kSecond = 1000 * kMs;
constexpr std::size_t kLeftPan = static_cast<std::size_t>(Joint::LeftEyePan);  // servo 3

struct Bench {
  explicit Bench(const PacketExchangeOptions& options = {}) {
    for (std::uint8_t id = 1; id <= 6; ++id) {
      emulator.add_servo(id).set(ax12::kReturnDelayTime, 0, 0);
    }
    exchange = std::make_unique<PacketExchange>(link, map, options, report, events);
  }
  void command(double left_pan_deg, bool torque_on = true) {
    ServoCommand goals;
    goals.goal_deg.fill(0);
    goals.goal_deg[kLeftPan] = left_pan_deg;
    goals.torque_on = torque_on;
    REQUIRE(exchange->send(goals) != ExchangeStatus::LinkGone);
  }
  void run(TimeNs duration_ns, TimeNs round_ns = 10 * kMs) {
    for (const TimeNs end_ns = link.now_ns() + duration_ns; link.now_ns() < end_ns;) {
      const TimeNs next_ns = link.now_ns() + round_ns;
      while (exchange->poll() == ExchangeStatus::Busy) {
      }
      link.sleep_until(next_ns);
    }
  }
  // Whether anything was told that contains `text`.
  bool was_told(const std::string& text) {
    for (const ServoEvent& event : events.take()) {
      told.push_back(event.text);
    }
    for (const std::string& line : told) {
      if (line.find(text) != std::string::npos) {
        return true;
      }
    }
    return false;
  }
  EmulatedServo& servo(std::uint8_t id) { return *emulator.find(id); }
  const JointReport& left_pan() const { return report.joints[kLeftPan]; }

  Ax12Emulator emulator;
  EmulatedLink link{emulator};
  ServoMap map;
  HeadReport report;
  ServoEventLog events;
  std::vector<std::string> told;
  std::unique_ptr<PacketExchange> exchange;
};

}  // namespace

TEST_CASE("degrees become units and back, in the joint's direction and inside its range") {
  ServoJoint joint{.id = 1, .direction = -1, .home_units = 500, .min_units = 400, .max_units = 600};
  CHECK(units_of(joint, 0) == 500);
  CHECK(*units_of(joint, 29.3255) == 400);
  CHECK(deg_of(joint, 400) == doctest::Approx(29.3255));
  CHECK(*units_of(joint, 90) == 400);
  CHECK(*units_of(joint, -90) == 600);
  CHECK_FALSE(units_of(joint, std::numeric_limits<double>::quiet_NaN()).has_value());
}

TEST_CASE("a bent map is undone to the unit, and one that turns back is noticed") {
  ServoJoint joint;
  joint.home_units = 500;
  joint.direction = -1;
  joint.min_units = 300;
  joint.max_units = 700;
  joint.bend_deg = {0.5, -0.7, 0.1};
  REQUIRE(is_monotonic(joint));
  CHECK(deg_of(joint, 600) == doctest::Approx(-(100 * joint.deg_per_unit + 0.5 - 0.7 + 0.1)));
  CHECK(deg_of(joint, 300) == doctest::Approx(-(-200 * joint.deg_per_unit + 0.5 * 4 + 0.7 * 8 + 0.1 * 16)));
  for (int units = 300; units <= 700; ++units) {
    CHECK(*units_of(joint, deg_of(joint, units)) == units);
  }
  CHECK(*units_of(joint, 1000) == 300);
  CHECK(*units_of(joint, -1000) == 700);
  CHECK_FALSE(units_of(joint, std::numeric_limits<double>::infinity()).has_value());
  joint.bend_deg[0] = 10;
  CHECK_FALSE(is_monotonic(joint));
}

TEST_CASE("servos are found, moved and measured, and none of them hears of a joint that is not meant") {
  Bench bench;
  CHECK(bench.exchange->begin() == ExchangeStatus::RoundOver);
  for (const JointReport& joint : bench.report.joints) {
    CHECK(joint.health == ServoHealth::Working);
  }
  ServoCommand only_left_pan;
  only_left_pan.goal_deg[kLeftPan] = 20;
  only_left_pan.joint_mask = 1U << kLeftPan;
  CHECK(bench.exchange->send(only_left_pan) == ExchangeStatus::Busy);
  bench.run(kSecond);
  CHECK(bench.left_pan().position_deg == doctest::Approx(20).epsilon(0.03));
  CHECK(bench.left_pan().supply_v == doctest::Approx(11.1));
  CHECK(bench.left_pan().temperature_c == 30);
  CHECK(bench.servo(3).get(ax12::kTorqueEnable) == 1);
  CHECK(bench.servo(1).get(ax12::kTorqueEnable) == 0);
  CHECK(bench.report.wire.troubles() == 0);
  CHECK(bench.events.take().empty());
}

TEST_CASE("no goal is written before the first command, and none after torque off") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.run(200 * kMs);
  CHECK(bench.servo(3).get(ax12::kTorqueEnable) == 0);
  bench.command(10);
  bench.run(500 * kMs);
  CHECK(bench.servo(3).get(ax12::kTorqueEnable) == 1);
  bench.command(10, false);
  bench.run(200 * kMs);
  for (std::uint8_t id = 1; id <= 6; ++id) {
    CHECK(bench.servo(id).get(ax12::kTorqueEnable) == 0);
  }
}

TEST_CASE("a joint's speed limit goes out with every goal") {
  Bench bench;
  bench.map.joints[kLeftPan].max_speed_deg_s = 100;
  bench.exchange =
      std::make_unique<PacketExchange>(bench.link, bench.map, PacketExchangeOptions{}, bench.report, bench.events);
  (void)bench.exchange->begin();
  bench.command(30);
  bench.run(20 * kMs);
  CHECK(bench.servo(3).get(ax12::kMovingSpeed) == 150);
  CHECK(bench.servo(4).get(ax12::kMovingSpeed) == 0);
}

TEST_CASE("a goal that is no number leaves the joint's goal as it was") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(10);
  bench.command(std::numeric_limits<double>::quiet_NaN());
  bench.run(20 * kMs);
  CHECK(bench.servo(3).get(ax12::kGoalPosition) == 546);
}

TEST_CASE("a lost servo is named within a quarter of a second, and welcomed when it is back") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(10);
  bench.run(kSecond);
  bench.emulator.pull_plug(3, bench.link.now_ns());
  const TimeNs lost_ns = bench.link.now_ns();
  while (bench.left_pan().health == ServoHealth::Working && bench.link.now_ns() - lost_ns < kSecond) {
    bench.run(10 * kMs);
  }
  CHECK(bench.link.now_ns() - lost_ns < 250 * kMs);
  CHECK(bench.was_told("servo 3 (left_eye_pan) has not answered for 0.2 s"));
  const TimeNs last_ns = bench.left_pan().measured_ns;
  bench.run(kSecond);
  CHECK(bench.left_pan().measured_ns == last_ns);
  CHECK(bench.report.joints[0].measured_ns == last_ns);
  CHECK(bench.report.joints[1].measured_ns > bench.link.now_ns() - 40 * kMs);  // the others go on

  bench.emulator.plug_in(3, bench.link.now_ns());
  bench.run(200 * kMs);
  CHECK(bench.left_pan().health == ServoHealth::Working);
  CHECK(bench.was_told("servo 3 (left_eye_pan) answers again"));
  // It gets no goal from before: it stays limp until it is commanded anew.
  CHECK(bench.servo(3).get(ax12::kTorqueEnable) == 0);
  bench.command(10);
  bench.run(100 * kMs);
  CHECK(bench.servo(3).get(ax12::kTorqueEnable) == 1);
}

TEST_CASE("a servo whose power failed for a moment is noticed and got ready again") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(10);
  bench.run(kSecond);
  bench.servo(3).power_cycle(bench.link.now_ns());
  bench.run(200 * kMs);
  CHECK(bench.was_told("servo 3 (left_eye_pan) was reset, as by a power cut; it is got ready again"));
  CHECK(bench.servo(3).get(ax12::kLock) == 1);
  bench.command(10);
  bench.run(100 * kMs);
  CHECK(bench.servo(3).get(ax12::kTorqueEnable) == 1);
}

// At 1 % byte errors a goal's packet becomes a whole packet for another address every few minutes; from 30 one flipped
// bit leads to 14, where the status return level is written to 0 and the servo never answers again.
TEST_CASE("the EEPROM is locked as soon as a servo is found") {
  Bench bench;
  (void)bench.exchange->begin();
  for (std::uint8_t id = 1; id <= 6; ++id) {
    CHECK(bench.servo(id).get(ax12::kLock) == 1);
  }
}

TEST_CASE("settings in RAM that something has changed are put back") {
  Bench bench;
  bench.servo(3).set(ax12::kCwComplianceMargin, 4, 0);  // the head's own, set by somebody before the start
  (void)bench.exchange->begin();
  bench.command(10);
  bench.run(200 * kMs);
  const TimeNs now_ns = bench.link.now_ns();
  bench.servo(3).set(ax12::kCwComplianceMargin, 200, now_ns);
  bench.servo(3).set(ax12::kCcwComplianceSlope, 128, now_ns);
  bench.servo(3).set(ax12::kPunch, 900, now_ns);
  bench.servo(3).set(ax12::kTorqueLimit, 100, now_ns);
  bench.run(200 * kMs);
  CHECK(bench.servo(3).get(ax12::kCwComplianceMargin) == 4);
  CHECK(bench.servo(3).get(ax12::kCcwComplianceSlope) == 32);
  CHECK(bench.servo(3).get(ax12::kPunch) == 32);
  CHECK(bench.servo(3).get(ax12::kTorqueLimit) == 1023);
}

TEST_CASE(
    "an overloaded servo rests, gets its own place as goal and its torque limit back, and is given up in the end") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(0);
  bench.run(200 * kMs);
  bench.emulator.find_motion(3)->block(true);
  bench.command(30);
  bench.run(1500 * kMs);
  CHECK(bench.left_pan().health == ServoHealth::ShutDown);
  CHECK(bench.was_told("servo 3 (left_eye_pan) reports overload"));
  CHECK(bench.was_told("has shut down and is limp; it is revived after 2.0 s"));
  CHECK(bench.servo(3).get(ax12::kTorqueLimit) == 0);

  bench.run(2 * kSecond);
  CHECK(bench.left_pan().health == ServoHealth::Working);
  CHECK(bench.servo(3).get(ax12::kTorqueLimit) == 1023);
  CHECK(bench.servo(3).get(ax12::kGoalPosition) == bench.servo(3).get(ax12::kPresentPosition));
  CHECK(bench.was_told("is revived: torque limit 1023 again"));

  for (int i = 0; i < 12; ++i) {  // it is still blocked, and the loop goes on wanting it to move
    bench.command(30);
    bench.run(kSecond);
  }
  CHECK(bench.left_pan().health == ServoHealth::GivenUp);
  CHECK(bench.was_told("shut down for the 4th time in 60.0 s and is left limp"));
}

TEST_CASE("a servo that freed itself moves again after its revival") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(0);
  bench.emulator.find_motion(3)->block(true);
  bench.command(30);
  bench.run(1500 * kMs);
  bench.emulator.find_motion(3)->block(false);
  bench.run(2500 * kMs);
  bench.command(30);
  bench.run(kSecond);
  CHECK(bench.left_pan().position_deg == doctest::Approx(30).epsilon(0.03));
}

TEST_CASE("a servo that is limp without an alarm is noticed and revived") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(10);
  bench.run(200 * kMs);
  // As a damaged SYNC_WRITE left all six of them, after four hours of a soak.
  bench.servo(3).set(ax12::kTorqueLimit, 0, bench.link.now_ns());
  bench.run(500 * kMs);
  CHECK(bench.left_pan().health == ServoHealth::ShutDown);
  bench.run(3000 * kMs);
  CHECK(bench.left_pan().health == ServoHealth::Working);
  CHECK(bench.servo(3).get(ax12::kTorqueLimit) == 1023);
  bench.command(-5);
  bench.run(1000 * kMs);
  CHECK(bench.left_pan().position_deg == doctest::Approx(-5).epsilon(0.15));
}

TEST_CASE("a hot servo is warned of, and revived only when it is well below its limit") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(0);
  bench.servo(3).set_temperature_c(66);
  bench.run(kSecond);
  CHECK(bench.was_told("servo 3 (left_eye_pan) is at 66 C and shuts down above 70 C"));
  bench.servo(3).set_temperature_c(71);
  bench.run(kSecond);
  CHECK(bench.left_pan().health == ServoHealth::ShutDown);
  CHECK(bench.was_told("reports overheating"));
  bench.servo(3).set_temperature_c(68);  // the alarm is over, but it is not cool
  bench.run(5 * kSecond);
  CHECK(bench.left_pan().health == ServoHealth::ShutDown);
  bench.servo(3).set_temperature_c(60);
  bench.run(3 * kSecond);
  CHECK(bench.left_pan().health == ServoHealth::Working);
}

TEST_CASE("a low supply is told, once, and its end too") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.command(0);
  bench.servo(3).set_supply_v(5.9);
  bench.run(kSecond);
  CHECK(bench.was_told("servo 3 (left_eye_pan) reports voltage"));
  CHECK(bench.told.size() == 1);
  CHECK(bench.left_pan().health == ServoHealth::Working);
  CHECK(bench.left_pan().supply_v == doctest::Approx(5.9));
  bench.servo(3).set_supply_v(11.1);
  bench.run(kSecond);
  CHECK(bench.was_told("no longer reports voltage"));
}

TEST_CASE("what is set up wrong is said at the start, with what to do") {
  Bench bench;
  bench.servo(3).set(ax12::kReturnDelayTime, 250, 0);
  bench.servo(4).set(ax12::kStatusReturnLevel, 0, 0);
  bench.servo(5).set(ax12::kCcwAngleLimit, 0, 0);
  bench.servo(6).set(ax12::kCwAngleLimit, 600, 0);
  bench.emulator.pull_plug(1, 0);
  (void)bench.exchange->begin();
  CHECK(bench.was_told("servo 1 (neck_pan) does not answer"));
  CHECK(bench.was_told("servo 3 (left_eye_pan) waits 500 us before each answer: write 0 to its return_delay_time"));
  CHECK(bench.was_told("servo 4 (left_eye_tilt) answers pings only: write 2 to its status_return_level"));
  CHECK(bench.was_told("servo 5 (right_eye_pan) is set up as a wheel"));
  bench.command(0);
  bench.run(100 * kMs);
  CHECK(bench.servo(6).get(ax12::kGoalPosition) == 600);  // the nearest that it takes
}

TEST_CASE("a port that vanishes is noticed at the next byte") {
  Bench bench;
  (void)bench.exchange->begin();
  bench.link.unplug();
  CHECK(bench.exchange->poll() == ExchangeStatus::LinkGone);
  CHECK_FALSE(bench.report.is_connected);
}

// The shaft is turned by hand while the wire is clean: too far for its motor, so it is asked again and believed.
TEST_CASE("a jump that no motor makes is believed only when it is confirmed") {
  PacketExchangeOptions trusting;
  trusting.noise_memory_ns = 0;
  Bench bench(trusting);
  (void)bench.exchange->begin();
  bench.run(100 * kMs);
  const std::uint64_t requests = bench.report.wire.requests;
  bench.emulator.find_motion(3)->turn_to(200);
  bench.run(10 * kMs);
  CHECK(bench.left_pan().position_deg == doctest::Approx(200 - 150.15).epsilon(0.01));
  CHECK(bench.report.wire.requests == requests + 7);
}

TEST_CASE("an ArbotiX passes enough for the head to move and be measured") {
  Bench bench;
  EmulatedArbotix board(bench.emulator);
  EmulatedLink link(board);
  PacketExchangeOptions options;
  options.bus = {.baud = EmulatedArbotix::kHostBaud, .adapter = BusAdapter::ArbotixRos};
  PacketExchange exchange(link, bench.map, options, bench.report, bench.events);
  CHECK(exchange.begin() == ExchangeStatus::RoundOver);
  ServoCommand goals;
  goals.goal_deg[kLeftPan] = 20;
  for (int round = 0; round < 200; ++round) {
    CHECK(exchange.send(goals) == ExchangeStatus::Busy);
    const TimeNs start_ns = link.now_ns();
    while (exchange.poll() == ExchangeStatus::Busy) {
    }
    // 115200 baud both ways; in the first five seconds everything is read twice.
    CHECK(link.now_ns() - start_ns < (round < 160 ? 40 : 20) * kMs);
    link.sleep_until(start_ns + 33 * kMs);
  }
  CHECK(bench.report.wire.troubles() == 0);
  CHECK(bench.left_pan().position_deg == doctest::Approx(20).epsilon(0.03));
  CHECK(bench.servo(3).get(ax12::kTorqueEnable) == 1);
}
