#include "tools/evaluate/protocol.h"

#include <doctest/doctest.h>

#include "tests/eval/evaluated_circuit.h"

using namespace tectum;

namespace {

ReadProtocol read(const std::string& rest) {
  return read_protocol_text("p.json", "{\"tectum_protocol\": 1, \"target\": {\"kind\": \"random\"}" + rest + "}");
}

}  // namespace

TEST_CASE("a protocol's quantities arrive in seconds, hertz and degrees") {
  const ReadProtocol found = read(
      R"(, "frame_rate": "20 Hz", "duration": "36 s", "hold": ["500 ms", "2 s"], "camera_latency": [1, 3],
          "servo_speed": "114.6 deg/s", "pid": [{"camera_latency": 3, "p": 0.4, "i": "7 Hz", "d": "15 ms"}])");
  REQUIRE_MESSAGE(found.protocol.has_value(), found.problems);
  const Protocol& protocol = *found.protocol;
  CHECK(protocol.frame_rate_hz == doctest::Approx(20));
  CHECK(protocol.duration_s == doctest::Approx(36));
  CHECK(protocol.servo_speed_deg_s == doctest::Approx(114.6));
  REQUIRE(protocol.pid.size() == 1);
  CHECK(protocol.pid[0].gains.i_hz == doctest::Approx(7));
  CHECK(protocol.pid[0].gains.d_s == doctest::Approx(0.015));
  const std::vector<Setting> settings = settings_of(protocol);
  REQUIRE(settings.size() == 4);
  CHECK(settings[1].hold_s == doctest::Approx(2));
  CHECK(settings[1].camera_latency_frames == 1);
  CHECK(settings[2].hold_s == doctest::Approx(0.5));
  CHECK(settings[2].camera_latency_frames == 3);
}

TEST_CASE("the gains of the nearest latency are taken") {
  const ReadProtocol found = read(R"(, "pid": [{"camera_latency": 1, "p": 0.1}, {"camera_latency": 5, "p": 0.5}])");
  REQUIRE(found.protocol.has_value());
  CHECK(pid_gains(*found.protocol, 0).p == 0.1);
  CHECK(pid_gains(*found.protocol, 4).p == 0.5);
}

TEST_CASE("a protocol of one kind of movement needs its sizes and no target") {
  const std::string head = R"({"tectum_protocol": 1, "kind": "saccades")";
  const ReadProtocol found = read_protocol_text("p.json", head + R"(, "sizes": ["5 deg", "10 deg"]})");
  REQUIRE_MESSAGE(found.protocol.has_value(), found.problems);
  CHECK(found.protocol->movement.sizes_deg == std::vector<double>{5, 10});
  const ReadProtocol without = read_protocol_text("p.json", head + "}");
  CHECK_FALSE(without.protocol.has_value());
  CHECK(without.problems.find("sizes") != std::string::npos);
  const ReadProtocol ramps = read_protocol_text(
      "p.json", R"({"tectum_protocol": 1, "kind": "pursuit", "speeds": ["5 deg/s"], "periods": []})");
  REQUIRE_MESSAGE(ramps.protocol.has_value(), ramps.problems);
  CHECK(ramps.protocol->movement.speeds_deg_s.at(0) == doctest::Approx(5));
}

TEST_CASE("what is wrong in a protocol is reported where it stands") {
  struct Case {
    std::string rest;
    std::string says;
  };
  for (const Case& each :
       {Case{R"(, "trails": 3)", "trails"}, Case{R"(, "trials": 0)", "trials"}, Case{R"(, "trials": 2.5)", "2.5"},
        Case{R"(, "duration": "3 deg")", "3 deg"}, Case{R"(, "camera_latency": [99])", "99"},
        Case{R"(, "kind": "physiologic")", "did you mean `physiology`?"},
        Case{R"(, "pid": {"p": 1})", "expected a list"}, Case{R"(, "published": {"by": "them"})", "rows"}}) {
    CAPTURE(each.rest);
    const ReadProtocol found = read(each.rest);
    CHECK_FALSE(found.protocol.has_value());
    CAPTURE(found.problems);
    CHECK(found.problems.find(each.says) != std::string::npos);
    CHECK(found.problems.find("p.json:1:") != std::string::npos);
  }
}

TEST_CASE("a protocol without a target, and a file that is not there, are said to be so") {
  const ReadProtocol no_target = read_protocol_text("p.json", R"({"tectum_protocol": 1})");
  CHECK_FALSE(no_target.protocol.has_value());
  CHECK(no_target.problems.find("target") != std::string::npos);
  const ReadProtocol absent = read_protocol_file("no/such/protocol.json");
  CHECK_FALSE(absent.protocol.has_value());
  CHECK(absent.error.find("no/such/protocol.json") != std::string::npos);
}

TEST_CASE("the PID servo is reported on other seeds than it is tuned on") {
  const Protocol paper = shipped_protocol("paper");
  CHECK(paper.tuning.first_seed >= paper.first_seed + static_cast<std::uint64_t>(paper.trials));
  CHECK(paper.pid.size() == 2);
}
