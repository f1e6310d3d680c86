#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "drivers/servo/emulated_link.h"
#include "drivers/servo/emulated_sketch.h"
#include "drivers/servo/sketch_exchange.h"

using namespace tectum;

namespace {

constexpr TimeNs kMs = 1'000'000;

std::vector<std::uint8_t> bytes(const std::string& text) { return {text.begin(), text.end()}; }

struct Bench {
  Bench() { exchange = std::make_unique<SketchExchange>(link, map, SketchExchangeOptions{}, report, events); }
  void run(const ServoCommand& goals, int lines) {
    for (int line = 0; line < lines; ++line) {
      REQUIRE(exchange->send(goals) == ExchangeStatus::Busy);
      REQUIRE(exchange->poll() == ExchangeStatus::RoundOver);
    }
  }
  double deg(Joint joint) const { return report.joints[static_cast<std::size_t>(joint)].position_deg; }

  EmulatedSketch head;
  EmulatedLink link{head};
  ServoMap map;
  HeadReport report;
  ServoEventLog events;
  std::unique_ptr<SketchExchange> exchange;
};

ServoCommand all_to(double deg) {
  ServoCommand goals;
  goals.goal_deg.fill(deg);
  return goals;
}

}  // namespace

TEST_CASE("a line has six fields, the neck first") {
  sketch::JointUnits units{};
  units[static_cast<std::size_t>(Joint::NeckPan)] = 401;
  units[static_cast<std::size_t>(Joint::NeckTilt)] = 402;
  units[static_cast<std::size_t>(Joint::LeftEyePan)] = 403;
  units[static_cast<std::size_t>(Joint::LeftEyeTilt)] = 404;
  units[static_cast<std::size_t>(Joint::RightEyePan)] = 405;
  units[static_cast<std::size_t>(Joint::RightEyeTilt)] = 406;
  CHECK(sketch::encode_line(units) == "401,402,403,404,405,406\n");
}

TEST_CASE("no line can hold a position outside the gate") {
  for (std::uint32_t value = 0; value <= 0xFFFF; value += 7) {
    sketch::JointUnits units;
    units.fill(static_cast<std::uint16_t>(value));
    const int sent = std::stoi(sketch::encode_line(units));
    CHECK(sent > 340);
    CHECK(sent < 700);
  }
}

TEST_CASE("an answer ends with an empty line, however its numbers are set apart") {
  for (const char* text : {"512,513,514,515,516,517\n\n", "512\r\n513\r\n514\r\n515\r\n516\r\n517\r\n\r\n",
                           "512 513 514 515 516 517\n\n", "\n\n512,513,514,515,516,517,\n\n"}) {
    CAPTURE(text);
    sketch::AnswerParser parser;
    const auto answer = parser.push(bytes(text));
    REQUIRE(answer.has_value());
    CHECK((*answer)[static_cast<std::size_t>(Joint::NeckPan)] == 512);
    CHECK((*answer)[static_cast<std::size_t>(Joint::RightEyeTilt)] == 517);
  }
}

TEST_CASE("an answer with too few, too many, too large or garbled numbers is none, and the next is read") {
  for (const char* text :
       {"512,513\n\n", "1,2,3,4,5,6,7\n\n", "512,513,514,515,516,5170\n\n", "512,5x3,514,515,516,517\n\n"}) {
    CAPTURE(text);
    sketch::AnswerParser parser;
    CHECK_FALSE(parser.push(bytes(text)).has_value());
    CHECK(parser.bad_answers() == 1);
    CHECK(parser.push(bytes("512,513,514,515,516,517\n\n")).has_value());
  }
}

// The fault that this driver must never set off.
TEST_CASE("the head's own program hangs on a neck goal outside the gate") {
  for (const char* line : {"700,512,512,512,512,512\n", "512,340,512,512,512,512\n", "\n"}) {
    EmulatedSketch head;
    head.receive(0, bytes(line));
    CHECK(head.is_hung());
  }
}

TEST_CASE("every angle that can be commanded leaves the head alive, NaN included") {
  Bench bench;
  REQUIRE(bench.exchange->begin() == ExchangeStatus::RoundOver);
  for (const double deg : {-1e9, -180.0, -50.2, -50.1, 50.0, 55.0, 1e9, std::nan("")}) {
    bench.run(all_to(deg), 40);
    REQUIRE_FALSE(bench.head.is_hung());
  }
}

TEST_CASE("the head is measured, and goes where it is told") {
  Bench bench;
  REQUIRE(bench.exchange->begin() == ExchangeStatus::RoundOver);
  for (const JointReport& joint : bench.report.joints) {
    CHECK(joint.health == ServoHealth::Working);
    CHECK(joint.position_deg == doctest::Approx(0));
  }
  bench.run(all_to(15), 60);
  CHECK(bench.deg(Joint::LeftEyePan) == doctest::Approx(15).epsilon(0.05));
  CHECK(bench.deg(Joint::NeckPan) == doctest::Approx(15).epsilon(0.05));
  CHECK(bench.report.wire.time_outs == 0);
}

TEST_CASE("the neck never holds the eyes up for more than twenty milliseconds") {
  Bench bench;
  REQUIRE(bench.exchange->begin() == ExchangeStatus::RoundOver);
  bench.run(all_to(40), 30);
  bench.run(all_to(-40), 30);
  CHECK(bench.head.longest_neck_move_ns() <= 20 * kMs);
  CHECK(bench.head.longest_neck_move_ns() > 0);
}

TEST_CASE("torque off cannot be had from this program, and that is said once") {
  Bench bench;
  REQUIRE(bench.exchange->begin() == ExchangeStatus::RoundOver);
  ServoCommand off;
  off.torque_on = false;
  (void)bench.exchange->send(off);
  (void)bench.exchange->send(off);
  const auto events = bench.events.take();
  REQUIRE(events.size() == 1);
  CHECK(events[0].text == "the head's own program cannot switch torque off: cut the servos' power");
}
