#include "tools/live/calibration.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

using namespace tectum;

namespace {

// An independent least-squares solution: the normal equations by Gauss-Jordan elimination with pivoting, in long
// double.
std::vector<long double> normal_equations(const std::vector<CalibrationPoint>& points, double centre, int degree) {
  const auto n = static_cast<std::size_t>(degree) + 1;
  std::vector<std::vector<long double>> a(n, std::vector<long double>(n + 1, 0));
  for (const CalibrationPoint& point : points) {
    std::vector<long double> powers(n, 1);
    for (std::size_t k = 1; k < n; ++k) {
      powers[k] = powers[k - 1] * (static_cast<long double>(point.units) - static_cast<long double>(centre)) / 100;
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        a[i][j] += powers[i] * powers[j];
      }
      a[i][n] += powers[i] * static_cast<long double>(point.angle_deg);
    }
  }
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column; row < n; ++row) {
      pivot = std::abs(a[row][column]) > std::abs(a[pivot][column]) ? row : pivot;
    }
    std::swap(a[column], a[pivot]);
    for (std::size_t row = 0; row < n; ++row) {
      const long double share = row == column ? 0 : a[row][column] / a[column][column];
      for (std::size_t k = column; k <= n; ++k) {
        a[row][k] -= share * a[column][k];
      }
    }
  }
  std::vector<long double> solution(n);
  for (std::size_t k = 0; k < n; ++k) {
    solution[k] = a[k][n] / a[k][k];
  }
  return solution;
}

double largest_difference(const CalibrationFit& fit, const CalibrationData& data) {
  const auto expected = normal_equations(data.points, fit.centre_units, fit.degree());
  double largest = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    largest = std::max(largest, std::abs(fit.coefficients_deg[k] - static_cast<double>(expected[k])));
  }
  return largest;
}

CalibrationData noisy(double slope, double bend) {
  CalibrationData data{"neck_pan", {}};
  for (int i = 0; i < 12; ++i) {
    const double units = 400 + 20 * i;
    const double x = (units - 512) / 100;
    data.points.push_back({units, slope * x + bend * x * x + 0.2 * std::sin(37.0 * i)});
  }
  return data;
}

CalibrationOptions of_degree(int degree) {
  CalibrationOptions options;
  options.degree = degree;
  return options;
}

struct TextFile {
  explicit TextFile(const std::string& text)
      : path(
            (std::filesystem::temp_directory_path() / ("tectum-cal-" + std::to_string(::getpid()) + ".csv")).string()) {
    std::ofstream(path) << text;
  }
  ~TextFile() { std::remove(path.c_str()); }
  std::string path;
};

}  // namespace

TEST_CASE("cross-validation finds a bend that is there, and its predictions get no better without one") {
  std::string error;
  const CalibrationFit bent = fit_calibration(noisy(29, 3), {}, error);
  CHECK(bent.degree() >= 2);
  CHECK(fit_calibration(noisy(29, 3), of_degree(2), error).coefficients_deg[2] == doctest::Approx(3).epsilon(0.15));
  CHECK(bent.cross_rmse_deg[0] > 2 * bent.cross_rmse_deg[1]);
  const CalibrationFit straight = fit_calibration(noisy(-29, 0), {}, error);
  for (const double cross_deg : straight.cross_rmse_deg) {
    CHECK(straight.cross_rmse_deg[static_cast<std::size_t>(straight.degree() - 1)] <= cross_deg);
  }
  CHECK(error == "");
}

TEST_CASE("the fit is the least-squares solution, of every degree") {
  const CalibrationData data = noisy(-29, 1);
  for (int degree = 1; degree <= kHighestDegree; ++degree) {
    std::string error;
    const CalibrationFit fit = fit_calibration(data, of_degree(degree), error);
    REQUIRE(fit.degree() == degree);
    CHECK(largest_difference(fit, data) < 1e-9);
  }
}

TEST_CASE("a fit turns the servo's units into the angles that were measured") {
  const CalibrationData data = noisy(-29, 1);
  std::string error;
  const CalibrationFit fit = fit_calibration(data, of_degree(2), error);
  ServoJoint joint;
  apply_calibration(fit, data, joint);
  CHECK(joint.direction == -1);
  CHECK(joint.min_units == 400);
  CHECK(joint.max_units == 620);
  for (const int units : {400, 450, 512, 600}) {
    CHECK(deg_of(joint, units) == doctest::Approx(fit.at(units) - fit.at(512)));
  }
}

TEST_CASE("too few places, and places that contradict each other, are told") {
  std::string error;
  (void)fit_calibration({"neck_pan", {{400, 1}, {500, 2}, {600, 3}}}, {}, error);
  CHECK(error == "neck_pan: measured at 3 places, too few to fit a line");
  error.clear();
  (void)fit_calibration({"neck_pan", {{400, 0}, {450, 9}, {500, 12}, {550, 9}, {600, 0}, {620, -5}}}, of_degree(2),
                        error);
  CHECK(error.find("turns back") != std::string::npos);
}

TEST_CASE("places on the wall become angles, and a bad line is named") {
  {
    const TextFile file(
        "joint,servo_position,wall_distance_cm,offset_added_cm\nneck_tilt,512,-19,19\nneck_tilt,600,36.3,19\n");
    const ReadCalibration read = read_calibration(file.path, {});
    REQUIRE(read.error == "");
    REQUIRE(read.joints.size() == 1);
    CHECK(read.joints[0].points[0].angle_deg == 0);
    CHECK(read.joints[0].points[1].angle_deg == doctest::Approx(45));
  }
  {
    const TextFile file("joint,servo_position,wall_distance_cm\nleft_eye_pan,512,-8\n");
    CalibrationOptions options;
    options.eye_half_baseline_cm = 8;
    CHECK(read_calibration(file.path, options).joints.at(0).points[0].angle_deg == 0);
  }
  {
    const TextFile file("joint,servo_position,angle_deg\nneck_pan,512,1\nneck_pan,x,2\n");
    CHECK(read_calibration(file.path, {}).error == file.path + ":3: not a joint and its numbers: neck_pan,x,2");
  }
  const TextFile file("a,b\n1,2\n");
  CHECK(read_calibration(file.path, {}).error.find("needs columns") != std::string::npos);
}

TEST_CASE("the measured head of 2020 gives an independent solution's numbers to 1e-6") {
  const std::string path = TECTUM_SOURCE_DIR "/../shared/data/servo_calibration.csv";
  if (!std::filesystem::exists(path)) {
    MESSAGE("no measured calibration beside the project: not compared");
    return;
  }
  const ReadCalibration read = read_calibration(path, {});
  REQUIRE(read.error == "");
  REQUIRE(read.joints.size() == 7);
  for (const CalibrationData& data : read.joints) {
    CAPTURE(data.joint);
    std::string error;
    CHECK(largest_difference(fit_calibration(data, {}, error), data) < 1e-6);
    CHECK(error == "");
    CHECK(largest_difference(fit_calibration(data, of_degree(kHighestDegree), error), data) < 1e-6);
  }
}
