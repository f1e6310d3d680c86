// The safety story of the head, told with a manual clock. Neutral, limits and speeds are distinct numbers, so that no
// angle can be right by accident.
#include "runtime/act/servo_guard.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace tectum;

namespace {

constexpr std::size_t kPan = 0, kTilt = 1;
constexpr double kNeutralPan = 3, kMinPan = -20, kMaxPan = 30, kSpeedPan = 100;
constexpr double kNeutralTilt = -2, kMinTilt = -11, kMaxTilt = 17;  // no speed limit
constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kTurn = 20 * kMs;

/// A head with two driven joints, and everything that a turn of the loop gives the guard.
struct Story {
  GuardOptions options;
  std::vector<JointRecord> records = {
      {.joint = Joint::LeftEyePan, .reserved = 0, .min_deg = kMinPan, .max_deg = kMaxPan, .max_speed_deg_s = kSpeedPan},
      {.joint = Joint::LeftEyeTilt, .reserved = 0, .min_deg = kMinTilt, .max_deg = kMaxTilt, .max_speed_deg_s = 0}};
  ServoGuard guard;
  TimeNs now_ns = 7'000 * kMs;  // a monotonic clock does not start at 0
  std::array<double, kJointCount> decoded{};
  ServoFeedback feedback;
  TimeNs camera_age_ns = 0;
  GuardRequest request = GuardRequest::None;
  ServoCommand command;
  bool is_sent = false;

  Story() : guard(make_guard()) { feedback.fresh_mask = 0b11; }

  ServoGuard make_guard() {
    options.neutral_deg = {kNeutralPan, kNeutralTilt};
    options.approach_speed_deg_s = 50;
    options.ease_speed_deg_s = 10;
    SpikeImage image;
    image.joints = records;
    return ServoGuard(image, options);
  }
  /// One turn; the time passes before it.
  std::string turn(TimeNs passed_ns = kTurn) {
    now_ns += passed_ns;
    is_sent = guard.decide({.now_ns = now_ns,
                            .decoded_deg = decoded,
                            .feedback = feedback,
                            .camera_age_ns = camera_age_ns,
                            .request = request},
                           command);
    return kGuardStateNames[static_cast<std::size_t>(guard.state())];
  }
  std::string turns(int count) {
    for (int i = 1; i < count; ++i) {
      turn();
    }
    return turn();
  }
  [[nodiscard]] double pan() const { return command.goal_deg[kPan]; }
  [[nodiscard]] double tilt() const { return command.goal_deg[kTilt]; }
};

/// Measured where it is told to be, and tracking.
Story tracking_story() {
  Story s;
  s.turn();
  REQUIRE(s.turn() == "tracking");
  return s;
}

}  // namespace

TEST_CASE("start, track, lose the camera, ease to neutral, recover") {
  Story s;
  s.feedback.fresh_mask = 0b01;
  s.feedback.position_deg = {12, -5};
  s.decoded = {12.5, -5.5};
  CHECK(s.turn() == "waiting");  // the tilt servo has not answered
  CHECK_FALSE(s.is_sent);
  CHECK(s.guard.lost_mask() == 0b10);

  s.feedback.fresh_mask = 0b11;
  CHECK(s.turn() == "approaching");
  CHECK(s.is_sent);
  CHECK(s.pan() == 12);
  CHECK(s.turn() == "tracking");  // 50 deg/s for 20 ms reach 1 deg
  CHECK(s.pan() == 12.5);
  CHECK(s.tilt() == -5.5);

  s.camera_age_ns = 249 * kMs;
  s.decoded = {14, -4};
  CHECK(s.turn() == "tracking");
  CHECK(s.pan() == 14);

  s.camera_age_ns = 250 * kMs;
  s.decoded = {25, 10};
  CHECK(s.turn() == "holding");
  CHECK(s.pan() == 14);
  CHECK(s.tilt() == -4);
  s.camera_age_ns = 999 * kMs;
  CHECK(s.turn() == "holding");
  CHECK(s.pan() == 14);

  s.camera_age_ns = 1000 * kMs;
  CHECK(s.turn() == "easing");
  CHECK(s.pan() == doctest::Approx(14 - 0.2));  // 10 deg/s for 20 ms
  CHECK(s.turns(100) == "easing");
  CHECK(s.pan() == kNeutralPan);
  CHECK(s.tilt() == kNeutralTilt);

  s.camera_age_ns = 60 * kMs;
  CHECK(s.turn() == "approaching");
  CHECK(s.pan() == doctest::Approx(kNeutralPan + 1));
  CHECK(s.turns(22) == "tracking");
  CHECK(s.pan() == 25);
  CHECK(s.tilt() == 10);
  CHECK(s.guard.counters().holds == 1);
}

TEST_CASE("the first command is where the joints are, whatever is decoded") {
  Story s;
  s.feedback.position_deg = {-9, 8};
  s.decoded = {29, -10};
  CHECK(s.turn() == "approaching");
  CHECK(s.pan() == -9);
  CHECK(s.tilt() == 8);
  s.turn();
  CHECK(s.pan() == doctest::Approx(-8));
  CHECK(s.tilt() == doctest::Approx(7));
}

TEST_CASE("a joint that already stands within a servo's unit of its decoded angle is tracked at once") {
  for (const double away_deg : {0.28, 0.31}) {
    Story story;
    story.feedback.position_deg[kPan] = 5;
    story.feedback.position_deg[kTilt] = 4;
    story.decoded[kPan] = 5 + away_deg;
    story.decoded[kTilt] = 4 - away_deg;
    story.turn(0);
    CHECK(story.command.goal_deg[kPan] == 5);  // no time, no movement
    story.decoded[kTilt] = 14;
    CHECK(story.turn() == std::string(away_deg < 0.3 ? "tracking" : "approaching"));
    CHECK(story.command.goal_deg[kTilt] == doctest::Approx(away_deg < 0.3 ? 14 : 5));  // 50 deg/s for 20 ms
  }
}

TEST_CASE("no goal leaves the joint's limits") {
  Story s = tracking_story();
  s.decoded = {1000, -1000};
  s.turns(30);
  CHECK(s.pan() == kMaxPan);
  CHECK(s.tilt() == kMinTilt);
  s.decoded = {-1000, 1000};
  s.turns(60);
  CHECK(s.pan() == kMinPan);
  CHECK(s.tilt() == kMaxTilt);
  CHECK(s.guard.counters().limited > 0);
}

TEST_CASE("a joint found outside its limits is brought back at the approach speed") {
  Story s;
  s.feedback.position_deg = {40, 0};
  s.decoded = {35, 0};
  s.turn();
  CHECK(s.pan() == 40);
  s.turn();
  CHECK(s.pan() == doctest::Approx(39));
  s.turns(20);
  CHECK(s.pan() == kMaxPan);
}

TEST_CASE("a goal moves no faster than the joint's speed limit") {
  Story s = tracking_story();
  s.decoded[kPan] = 25;
  s.turn();
  CHECK(s.pan() == doctest::Approx(2));  // 100 deg/s for 20 ms
  s.turn(10 * kMs);
  CHECK(s.pan() == doctest::Approx(3));
  CHECK(s.guard.counters().slewed == 2);
}

TEST_CASE("an angle that is not finite holds its joint and no other") {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    Story s = tracking_story();
    s.decoded = {1.5, 4};
    s.turn();
    s.decoded = {bad, 5};
    CHECK(s.turn() == "tracking");
    CHECK(s.pan() == 1.5);
    CHECK(s.tilt() == 5);
    CHECK(s.guard.counters().not_finite == 1);
  }
}

TEST_CASE("a clock that jumps moves no joint further than the longest step") {
  Story s = tracking_story();
  s.decoded[kPan] = 29;
  s.turn(3'600'000 * kMs);
  CHECK(s.pan() == doctest::Approx(10));  // 100 deg/s for 100 ms
  s.turn(-3'600'000 * kMs);
  CHECK(s.pan() == doctest::Approx(10));
  CHECK(s.guard.counters().clock_jumps == 2);
}

TEST_CASE("a servo that stops answering holds its goal, and starts again from where it is found") {
  Story s = tracking_story();
  s.decoded = {6, 4};
  s.turns(4);
  s.feedback.fresh_mask = 0b10;
  s.turns(24);
  CHECK(s.guard.lost_mask() == 0);  // 480 ms: reads may fail for a while
  s.turn();
  CHECK(s.guard.lost_mask() == 0b01);
  s.decoded = {9, 7};
  s.turn();
  CHECK(s.pan() == 6);
  CHECK(s.tilt() == 7);
  s.feedback.fresh_mask = 0b11;
  s.feedback.position_deg[kPan] = -3;  // it sagged
  CHECK(s.turn() == "approaching");
  CHECK(s.pan() == doctest::Approx(-2));
  CHECK(s.turns(11) == "tracking");
  CHECK(s.pan() == 9);
  CHECK(s.guard.counters().losses == 1);
}

TEST_CASE("a measured angle that is no number is no measurement") {
  Story s;
  s.feedback.position_deg = {std::numeric_limits<double>::quiet_NaN(), 0};
  CHECK(s.turn() == "waiting");
  CHECK_FALSE(s.is_sent);
}

TEST_CASE("an emergency stop freezes the head where it is until it is resumed") {
  Story s = tracking_story();
  s.decoded = {20, 10};
  s.turns(5);
  s.feedback.position_deg = {7, 9};  // the servos lag behind their goals
  s.request = GuardRequest::Stop;
  CHECK(s.turn() == "stopped");
  CHECK(s.command.torque_on);
  CHECK(s.pan() == 7);
  CHECK(s.tilt() == 9);
  s.request = GuardRequest::None;
  s.feedback.position_deg = {6.5, 8.5};
  s.camera_age_ns = 5'000 * kMs;
  CHECK(s.turns(50) == "stopped");
  CHECK(s.pan() == 7);
  s.camera_age_ns = 0;
  s.guard.resume();
  CHECK(s.turn() == "approaching");
  CHECK(s.pan() == 6.5);
  s.turn();
  CHECK(s.pan() == doctest::Approx(7.5));
}

TEST_CASE("a stop without a recent measurement keeps the last goals") {
  Story s = tracking_story();
  s.decoded = {2, 10};
  s.turn();
  s.feedback.fresh_mask = 0;
  s.turns(3);
  s.request = GuardRequest::Stop;
  CHECK(s.turn() == "stopped");
  CHECK(s.pan() == 2);
  CHECK(s.tilt() == 10);
}

TEST_CASE("a stop before the joints are measured sends nothing until they are") {
  Story s;
  s.feedback.fresh_mask = 0;
  s.request = GuardRequest::Stop;
  CHECK(s.turn() == "waiting");
  CHECK_FALSE(s.is_sent);
  s.feedback.fresh_mask = 0b11;
  s.feedback.position_deg = {4, 5};
  CHECK(s.turn() == "stopped");
  CHECK(s.pan() == 4);
}

TEST_CASE("parking eases to neutral and stays there; releasing turns the torque off") {
  Story s = tracking_story();
  s.decoded = {5, 5};
  s.turns(10);
  s.request = GuardRequest::Park;
  CHECK(s.turn() == "parking");
  CHECK(s.pan() == doctest::Approx(4.8));
  CHECK_FALSE(s.guard.is_parked());
  s.request = GuardRequest::None;
  CHECK(s.turns(60) == "parking");
  CHECK(s.guard.is_parked());
  CHECK(s.pan() == kNeutralPan);
  CHECK(s.tilt() == kNeutralTilt);
  s.request = GuardRequest::Release;
  CHECK(s.turn() == "released");
  CHECK(s.is_sent);
  CHECK_FALSE(s.command.torque_on);
  s.request = GuardRequest::Stop;
  CHECK(s.turn() == "released");
  s.request = GuardRequest::None;
  s.guard.resume();
  CHECK(s.turn() == "approaching");
  CHECK(s.command.torque_on);
}

TEST_CASE("torque can be turned off before anything is measured") {
  Story s;
  s.feedback.fresh_mask = 0;
  s.request = GuardRequest::Release;
  CHECK(s.turn() == "released");
  CHECK(s.is_sent);
  CHECK_FALSE(s.command.torque_on);
}

TEST_CASE("a joint that the circuit does not drive stays where it was first measured") {
  Story s = tracking_story();
  CHECK(s.command.joint_mask == 0b11);
  s.feedback.position_deg[4] = 13;
  s.feedback.fresh_mask = 0b10011;
  s.decoded[4] = 44;
  s.turn();
  s.feedback.position_deg[4] = 12;
  s.turn();
  CHECK(s.command.goal_deg[4] == 13);
  CHECK(s.command.joint_mask == 0b10011);
}
