#include <doctest/doctest.h>

#include <cmath>

#include "drivers/head/eye_camera.h"

using namespace tectum;

namespace {

// Weighted by how much brighter than the wall a pixel is, in one channel.
PixelPoint centroid(const cv::Mat& picture, int channel, double wall) {
  double sum = 0, sum_x = 0, sum_y = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double light = picture.at<cv::Vec3b>(y, x)[channel] - wall;
      if (light > 20) {
        sum += light;
        sum_x += light * x;
        sum_y += light * y;
      }
    }
  }
  REQUIRE(sum > 0);
  return {sum_x / sum, sum_y / sum};
}

int pixels_above(const cv::Mat& picture, int channel, int level) {
  int count = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      count += picture.at<cv::Vec3b>(y, x)[channel] > level ? 1 : 0;
    }
  }
  return count;
}

const JointAngles kHome{};

}  // namespace

TEST_CASE("the drawn dot lies within a fifth of a pixel of its projection, at any pose") {
  const HeadGeometry g;
  const EyeCameraParams params;
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    EyeCamera camera(params, g, static_cast<std::uint32_t>(eye));
    std::uint64_t sequence = 0;
    // Order of joints: left eye pan and tilt, right eye pan and tilt, neck pan and tilt.
    for (const JointAngles& angles :
         {kHome, {5, 3, -5, 3, 0, 0}, {12, -8, 9, -8, 10, 5}, {-14, 6, -17, 7, -12, -6}, {20, 15, 16, 15, 5, 10}}) {
      const EyePose pose = eye_pose(g, angles, eye);
      const WallPoint gaze = gaze_on_wall(g, pose);
      for (const auto& [right_m, up_m] : {std::pair{0.0, 0.0}, {0.031, -0.017}, {-0.1, 0.083}, {0.0513, 0.12}}) {
        const WallPoint dot = {gaze[0] + right_m, gaze[1] + up_m};
        PixelPoint truth;
        REQUIRE(camera.project(pose, wall_to_base(g, dot), truth));
        const PixelPoint seen = centroid(camera.render(pose, dot, sequence++), 2, params.wall_brightness);
        CAPTURE(right_m);
        CAPTURE(angles[0]);
        CHECK(std::abs(seen.x - truth.x) < 0.2);
        CHECK(std::abs(seen.y - truth.y) < 0.2);
      }
    }
  }
}

TEST_CASE("a dot to the right of the axis is drawn to the right, one above it is drawn above") {
  const HeadGeometry g;
  EyeCamera camera({}, g, 0);
  const EyePose pose = eye_pose(g, kHome, Eye::Left);
  const PixelPoint seen = centroid(camera.render(pose, {-0.060 + 0.05, 0.03}, 0), 2, 12);
  CHECK(seen.x == doctest::Approx(159.5 + camera.focal_px() * 0.05 / 0.545).epsilon(0.002));
  CHECK(seen.y == doctest::Approx(159.5 - camera.focal_px() * 0.03 / 0.545).epsilon(0.002));
}

TEST_CASE("the field of view is what reaches the frame's edges") {
  const HeadGeometry g;
  EyeCamera camera({}, g, 0);
  const EyePose pose = eye_pose(g, kHome, Eye::Left);
  PixelPoint edge;
  const double half_m = 0.545 * std::tan(0.5 * 39.4 * 3.14159265358979 / 180);
  REQUIRE(camera.project(pose, wall_to_base(g, {-0.060 + half_m, 0}), edge));
  CHECK(edge.x == doctest::Approx(319.5));  // the outer border of the last pixel
}

TEST_CASE("the dot grows as the eye comes nearer and with the resolution") {
  const EyeCameraParams params;
  HeadGeometry near_wall;
  near_wall.wall_distance_m = 0.275;
  const HeadGeometry far_wall;
  EyeCamera near_camera(params, near_wall, 0), far_camera(params, far_wall, 0);
  const int near_px = pixels_above(near_camera.render(eye_pose(near_wall, kHome, Eye::Left), {-0.06, 0}, 0), 2, 128);
  const int far_px = pixels_above(far_camera.render(eye_pose(far_wall, kHome, Eye::Left), {-0.06, 0}, 0), 2, 128);
  CHECK(far_px >= 6);
  CHECK(near_px > 3 * far_px);
}

TEST_CASE("a dot out of view or behind the eye leaves the plain wall alone") {
  const HeadGeometry g;
  EyeCamera camera({}, g, 0);
  const EyePose pose = eye_pose(g, kHome, Eye::Left);
  CHECK(pixels_above(camera.render(pose, {0.5, 0}, 0), 2, 12) == 0);
  CHECK(pixels_above(camera.render(pose, {-0.06, 0}, 1), 2, 12) > 0);
  CHECK(pixels_above(camera.render(pose, {0.5, 0}, 2), 2, 12) == 0);
  EyePose behind = pose;
  behind.axes.col(0) *= -1;
  behind.axes.col(2) *= -1;
  CHECK(pixels_above(camera.render(behind, {-0.06, 0}, 3), 2, 12) == 0);
}

TEST_CASE("the dot's own channel saturates and leads the others, in each colour") {
  const HeadGeometry g;
  const EyePose pose = eye_pose(g, kHome, Eye::Left);
  for (const auto& [colour, channel] : {std::pair{DotColour::Red, 2}, {DotColour::Green, 1}, {DotColour::Blue, 0}}) {
    EyeCameraParams params;
    params.dot_colour = colour;
    EyeCamera camera(params, g, 0);
    const cv::Vec3b middle = camera.render(pose, {-0.06, 0}, 0).at<cv::Vec3b>(160, 160);
    CHECK(middle[channel] == 255);
    CHECK(middle[(channel + 1) % 3] < 100);
    CHECK(middle[(channel + 2) % 3] < 100);
  }
}

TEST_CASE("noise has the asked size, differs from frame to frame and eye to eye, and repeats with its seed") {
  const HeadGeometry g;
  EyeCameraParams params;
  params.noise_sigma = 3;
  params.wall_brightness = 60;
  const EyePose pose = eye_pose(g, kHome, Eye::Left);
  EyeCamera camera(params, g, 0), same(params, g, 0), other_eye(params, g, 1);
  const cv::Mat first = camera.render(pose, {0.5, 0}, 0).clone();
  const cv::Mat second = camera.render(pose, {0.5, 0}, 1).clone();
  cv::Scalar mean, deviation;
  cv::meanStdDev(first, mean, deviation);
  for (int c = 0; c < 3; ++c) {
    CHECK(mean[c] == doctest::Approx(60).epsilon(0.01));
    CHECK(deviation[c] == doctest::Approx(3).epsilon(0.03));
  }
  CHECK(cv::norm(first, second, cv::NORM_INF) > 0);
  CHECK(cv::norm(first, same.render(pose, {0.5, 0}, 0), cv::NORM_INF) == 0);
  CHECK(cv::norm(first, other_eye.render(pose, {0.5, 0}, 0), cv::NORM_INF) > 0);
}

TEST_CASE("clutter is fixed to the wall: a box falls where its corner projects, wherever the eye looks") {
  const HeadGeometry g;
  EyeCameraParams params;
  params.clutter = true;
  EyeCamera camera(params, g, 0);
  // The green box, left of the middle and below it.
  for (const JointAngles& angles : {JointAngles{-8, -8, 0, 0, 0, 0}, {-14, -5, 0, 0, 0, 0}, {-3, -10, 0, 0, -8, 2}}) {
    const EyePose pose = eye_pose(g, angles, Eye::Left);
    const cv::Mat& picture = camera.render(pose, {0.5, 0.4}, 0);
    const auto at = [&](double right_m, double up_m) {
      PixelPoint p;
      REQUIRE(camera.project(pose, wall_to_base(g, {right_m, up_m}), p));
      return picture.at<cv::Vec3b>(cvRound(p.y), cvRound(p.x));
    };
    CHECK(at(-0.185, -0.115)[1] > 120);
    CHECK(at(-0.217, -0.137)[1] > 120);
    CHECK(at(-0.153, -0.093)[1] > 120);
    CHECK(at(-0.229, -0.115)[1] < 60);
    CHECK(at(-0.185, -0.082)[1] < 60);
  }
}

TEST_CASE("on a cluttered, noisy wall only the dot is far redder than it is green and blue") {
  const HeadGeometry g;
  EyeCameraParams params;
  params.clutter = true;
  params.noise_sigma = 3;
  EyeCamera camera(params, g, 0);
  for (const double pan : {-20.0, 0.0, 15.0, 30.0}) {
    const EyePose pose = eye_pose(g, {pan, 0, 0, 0, 0, 0}, Eye::Left);
    const WallPoint gaze = gaze_on_wall(g, pose);
    if (gaze[0] > 0.35) {
      continue;  // the window saturates every channel: no dot can be told there
    }
    const cv::Mat& picture = camera.render(pose, {gaze[0] + 0.02, 0.03}, 0);
    PixelPoint truth;
    REQUIRE(camera.project(pose, wall_to_base(g, {gaze[0] + 0.02, 0.03}), truth));
    int at_dot = 0, elsewhere = 0;
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        const auto& p = picture.at<cv::Vec3b>(y, x);
        if (p[2] - std::max(p[0], p[1]) > 130) {
          ++(std::hypot(x - truth.x, y - truth.y) < 4 ? at_dot : elsewhere);
        }
      }
    }
    CAPTURE(pan);
    CHECK(at_dot >= 4);
    CHECK(elsewhere == 0);
  }
}
