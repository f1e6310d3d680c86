#include "tools/live/head_file.h"

#include <doctest/doctest.h>

using namespace tectum;

namespace {

ReadHead read(const std::string& joints, const std::string& rest = "") {
  return read_head_text("head.json", "{\"tectum_head\": 1, \"link\": {\"kind\": \"emulated\"}, \"joints\": {" + joints +
                                         "}" + rest + "}");
}

bool says(const ReadHead& read, const std::string& what) { return read.problems.find(what) != std::string::npos; }

ServoJoint& neck_pan(ReadHead& head) { return head.head->map.joints[static_cast<std::size_t>(Joint::NeckPan)]; }

}  // namespace

TEST_CASE("a joint's angles become the servo's own range") {
  ReadHead head = read(R"("neck_pan": {"id": 7, "direction": -1, "home": 500, "deg_per_unit": "0.3 deg",
                          "limits": ["-30 deg", "15 deg"], "speed": "60 deg/s", "torque_limit": "50 %"})");
  REQUIRE_MESSAGE(head.head.has_value(), head.problems);
  const ServoJoint& joint = neck_pan(head);
  CHECK(joint.is_present);
  CHECK(joint.id == 7);
  CHECK(joint.direction == -1);
  CHECK(joint.min_units == 450);  // +15 deg
  CHECK(joint.max_units == 600);  // -30 deg
  CHECK(joint.max_speed_deg_s == doctest::Approx(60));
  CHECK(joint.torque_limit == 512);
  CHECK_FALSE(head.head->map.joints[0].is_present);
  CHECK(head.head->is_emulated);
}

TEST_CASE("a bend changes the range that a limit in degrees means") {
  ReadHead head = read(R"("neck_pan": {"id": 1, "deg_per_unit": "0.3 deg", "bend": ["1 deg", "0.5 deg"],
                          "limits": ["-29 deg", "31.5 deg"]})");
  REQUIRE_MESSAGE(head.head.has_value(), head.problems);
  const ServoJoint& joint = neck_pan(head);
  CHECK(joint.max_units == 512 + 100);  // 30 + 1 + 0.5
  CHECK(deg_of(joint, joint.min_units) >= -29);
  CHECK(deg_of(joint, joint.min_units - 1) < -29);
}

TEST_CASE("mistakes in a head file are told with their place and what would be right") {
  CHECK(says(read(R"("neck_pna": {"id": 1})"), "unknown key `neck_pna`"));
  CHECK(says(read(R"("neck_pan": {"id": 1})", R"(, "cameras": {"left": {"kind": "devise", "path": "x"}})"),
             "did you mean `device`?"));
  CHECK(says(read(R"("neck_pan": {"id": 1, "limits": ["-30 mV", "30 deg"]})"), "head.json:1:"));
  CHECK(says(read(R"("neck_pan": {"id": 1, "limits": ["30 deg", "-30 deg"]})"), "runs from 30 deg to -30 deg"));
  CHECK(says(read(R"("neck_pan": {"id": 300})"), "expected 0 to 253"));
  CHECK(says(read(R"("neck_pan": {"direction": 1})"), "has no `id`"));
  CHECK(says(read(R"("neck_pan": {"id": 3}, "neck_tilt": {"id": 3})"), "`servo 3` is declared twice"));
  CHECK(says(read(R"("neck_pan": {"id": 1, "bend": ["40 deg"]})"), "turns back"));
  CHECK(says(read_head_text("h", R"({"tectum_head": 1, "link": {"kind": "direct"}, "joints": {}})"), "`port`"));
  CHECK(says(read_head_text("h", "{"), "h:1:"));
  CHECK_FALSE(read(R"("neck_pan": {"id": 300})").head.has_value());
}

TEST_CASE("a simulated eye needs the simulated head") {
  const std::string text = R"({"tectum_head": 1, "link": {"kind": "direct", "port": "/dev/ttyUSB0"},
    "joints": {"neck_pan": {"id": 1}}, "cameras": {"left": {"kind": "simulated"}}})";
  CHECK(says(read_head_text("h", text), "needs the simulated head"));
}

TEST_CASE("new joints replace the old ones and nothing else of the text") {
  const std::string text = R"({
  // kept
  "tectum_head": 1, "link": {"kind": "emulated"},
  "joints": {"neck_pan": {"id": 1}}, "cameras": {}
})";
  ReadHead head = read_head_text("h", text);
  REQUIRE_MESSAGE(head.head.has_value(), head.problems);
  ServoJoint& joint = neck_pan(head);
  joint.id = 9;
  joint.direction = -1;
  joint.home_units = 500;
  joint.deg_per_unit = 0.31;
  joint.bend_deg = {0.25, -0.125, 0};
  joint.min_units = 300;
  joint.max_units = 700;
  joint.max_speed_deg_s = 45;
  std::array<double, kJointCount> neutral_deg{};
  neutral_deg[static_cast<std::size_t>(Joint::NeckPan)] = 2.5;
  const auto written = with_joints(text, head.head->map, neutral_deg);
  REQUIRE(written.has_value());
  CHECK(written->find("// kept") != std::string::npos);
  ReadHead again = read_head_text("h", *written);
  REQUIRE_MESSAGE(again.head.has_value(), again.problems);
  const ServoJoint& back = neck_pan(again);
  CHECK(back.id == 9);
  CHECK(back.deg_per_unit == 0.31);
  CHECK(back.bend_deg == joint.bend_deg);
  CHECK(back.min_units == 300);
  CHECK(back.max_units == 700);
  CHECK(back.max_speed_deg_s == doctest::Approx(45));
  CHECK(again.head->neutral_deg[static_cast<std::size_t>(Joint::NeckPan)] == 2.5);
}

TEST_CASE("the head files of the project are sound") {
  for (const char* const name : {"emulated", "head2020"}) {
    const ReadHead head = read_head_file(std::string(TECTUM_SOURCE_DIR "/circuits/heads/") + name + ".json");
    CHECK_MESSAGE(head.head.has_value(), head.error << head.problems);
    CHECK(head.problems == "");
  }
}
