#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "drivers/head/kinematics.h"
#include "drivers/head/random_streams.h"

using namespace tectum;

namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

JointAngles joints(std::initializer_list<std::pair<Joint, double>> set) {
  JointAngles angles{};
  for (const auto& [joint, deg] : set) {
    angles[index_of(joint)] = deg;
  }
  return angles;
}

}  // namespace

TEST_CASE("at home both eyes look straight ahead from either side of the neck") {
  const HeadGeometry g;
  const EyePose left = eye_pose(g, {}, Eye::Left);
  const EyePose right = eye_pose(g, {}, Eye::Right);
  CHECK(left.position_m.isApprox(Eigen::Vector3d(-0.060, 0, 0.005)));
  CHECK(right.position_m.isApprox(Eigen::Vector3d(0.060, 0, 0.005)));
  CHECK(left.axes.isIdentity(1e-12));
  CHECK(gaze_on_wall(g, left)[0] == doctest::Approx(-0.060));
  CHECK(gaze_on_wall(g, left)[1] == doctest::Approx(0));
}

TEST_CASE("a target straight ahead lies to the nose of each parallel eye") {
  const HeadGeometry g;
  const double nasal_deg = std::atan2(0.060, 0.545) * kDegPerRad;  // 6.28
  const Eigen::Vector3d ahead = wall_to_base(g, {0, 0});
  CHECK(error_in_eye(eye_pose(g, {}, Eye::Left), ahead).pan_deg == doctest::Approx(nasal_deg));
  CHECK(error_in_eye(eye_pose(g, {}, Eye::Right), ahead).pan_deg == doctest::Approx(-nasal_deg));
  CHECK(error_in_eye(eye_pose(g, {}, Eye::Right), ahead).tilt_deg == doctest::Approx(0));
}

TEST_CASE("pan turns the gaze to the right and tilt turns it up, one eye at a time") {
  const HeadGeometry g;
  const auto angles = joints({{Joint::LeftEyePan, 10}, {Joint::RightEyeTilt, 7}});
  const Direction left = gaze_direction(eye_pose(g, angles, Eye::Left));
  const Direction right = gaze_direction(eye_pose(g, angles, Eye::Right));
  CHECK(left.pan_deg == doctest::Approx(10));
  CHECK(left.tilt_deg == doctest::Approx(0));
  CHECK(right.pan_deg == doctest::Approx(0));
  CHECK(right.tilt_deg == doctest::Approx(7));
  // x = -0.060 + 0.545 tan 10 deg
  CHECK(gaze_on_wall(g, eye_pose(g, angles, Eye::Left))[0] == doctest::Approx(-0.060 + 0.545 * 0.17632698));
}

TEST_CASE("neck pan and eye pan add, and the neck carries the eyes about its axis") {
  const HeadGeometry g;
  const auto angles = joints({{Joint::NeckPan, 20}, {Joint::RightEyePan, 15}});
  const EyePose right = eye_pose(g, angles, Eye::Right);
  CHECK(gaze_direction(right).pan_deg == doctest::Approx(35));
  CHECK(right.position_m.x() == doctest::Approx(0.060 * std::cos(20 / kDegPerRad) + 0.005 * std::sin(20 / kDegPerRad)));
  CHECK(right.position_m.z() == doctest::Approx(0.005 * std::cos(20 / kDegPerRad) - 0.060 * std::sin(20 / kDegPerRad)));
  CHECK(right.position_m.y() == doctest::Approx(0));
}

TEST_CASE("neck tilt lifts the gaze and takes the cameras back and down on an arc") {
  const HeadGeometry g;
  const EyePose pose = eye_pose(g, joints({{Joint::NeckTilt, 30}}), Eye::Left);
  CHECK(gaze_direction(pose).tilt_deg == doctest::Approx(30));
  const double arm_m = 0.112 + 0.054;
  CHECK(pose.position_m.y() == doctest::Approx(arm_m * (std::cos(30 / kDegPerRad) - 1) + 0.005 * 0.5));
  CHECK(pose.position_m.z() == doctest::Approx(-arm_m * 0.5 + 0.005 * std::cos(30 / kDegPerRad)));
}

TEST_CASE("eye tilt is about the eye's own axis below the camera") {
  const HeadGeometry g;
  const EyePose pose = eye_pose(g, joints({{Joint::LeftEyeTilt, 90}}), Eye::Left);
  CHECK(pose.position_m.y() == doctest::Approx(-0.054));
  CHECK(pose.position_m.z() == doctest::Approx(0.005 - 0.054));
}

TEST_CASE("tilt comes after pan: a tilted eye keeps its pan direction") {
  const HeadGeometry g;
  const Direction gaze =
      gaze_direction(eye_pose(g, joints({{Joint::LeftEyePan, 25}, {Joint::LeftEyeTilt, 20}}), Eye::Left));
  CHECK(gaze.pan_deg == doctest::Approx(25));
  CHECK(gaze.tilt_deg == doctest::Approx(20));
}

TEST_CASE("the angles towards a wall point bring the error to zero and the gaze onto the point") {
  const HeadGeometry g;
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    for (const WallPoint point : {WallPoint{0, 0}, {0.2, 0.1}, {-0.25, -0.14}, {0.05, -0.2}}) {
      for (const auto& [neck_pan, neck_tilt] : {std::pair{0.0, 0.0}, {12.0, -8.0}, {-20.0, 15.0}}) {
        CAPTURE(point[0]);
        CAPTURE(neck_pan);
        const Direction aim = eye_angles_towards(g, neck_pan, neck_tilt, eye, point);
        auto angles = joints({{Joint::NeckPan, neck_pan}, {Joint::NeckTilt, neck_tilt}});
        angles[index_of(eye == Eye::Left ? Joint::LeftEyePan : Joint::RightEyePan)] = aim.pan_deg;
        angles[index_of(eye == Eye::Left ? Joint::LeftEyeTilt : Joint::RightEyeTilt)] = aim.tilt_deg;
        const EyePose pose = eye_pose(g, angles, eye);
        const Direction error = error_in_eye(pose, wall_to_base(g, point));
        CHECK(std::abs(error.pan_deg) < 1e-6);
        CHECK(std::abs(error.tilt_deg) < 1e-6);
        CHECK(gaze_on_wall(g, pose)[0] == doctest::Approx(point[0]).epsilon(1e-6));
        CHECK(gaze_on_wall(g, pose)[1] == doctest::Approx(point[1]).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("an axis that misses the wall still gives a finite point") {
  const HeadGeometry g;
  const EyePose pose = eye_pose(g, joints({{Joint::NeckPan, 60}, {Joint::LeftEyePan, 50}}), Eye::Left);
  CHECK(std::isfinite(gaze_on_wall(g, pose)[0]));
  CHECK(gaze_on_wall(g, pose)[0] > 5);
}

TEST_CASE("what is drawn depends on seed, purpose, index and part as it always has") {
  // A known answer of the generator's own test (Random123, kat_vectors, philox4x32 10), spread over the four.
  const auto purpose = static_cast<head::Stream>(0x03707344);
  CHECK(head::draw(0x299f31d0a4093822ULL, purpose, 0x85a308d3243f6a88ULL, 0x13198a2e) ==
        PhiloxWords{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
  CHECK(head::draw(7, head::Stream::RandomTarget, 0) != head::draw(7, head::Stream::SensorNoise, 0));
}
