#include "tools/live/calibration.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>

#include "compiler/source/source_file.h"
#include "tools/report/chart.h"

namespace tectum {
namespace {

/// By Householder QR with column pivoting, which squares no condition number. `without` is left out; -1: none.
Eigen::VectorXd solve(const std::vector<CalibrationPoint>& points, double centre, int degree, std::ptrdiff_t without) {
  const auto count = static_cast<Eigen::Index>(points.size()) - (without >= 0 ? 1 : 0);
  Eigen::MatrixXd powers(count, degree + 1);
  Eigen::VectorXd angle_deg(count);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (static_cast<std::ptrdiff_t>(i) == without) {
      continue;
    }
    double power = 1;
    for (Eigen::Index k = 0; k <= degree; ++k) {
      powers(row, k) = power;
      power *= (points[i].units - centre) / 100;
    }
    angle_deg(row++) = points[i].angle_deg;
  }
  return powers.colPivHouseholderQr().solve(angle_deg);
}

double value_at(const Eigen::VectorXd& coefficients, double x) {
  double value = 0;
  for (Eigen::Index k = coefficients.size(); k-- > 0;) {
    value = value * x + coefficients(k);
  }
  return value;
}

double leave_one_out_rmse(const std::vector<CalibrationPoint>& points, double centre, int degree) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::VectorXd others = solve(points, centre, degree, static_cast<std::ptrdiff_t>(i));
    const double miss = points[i].angle_deg - value_at(others, (points[i].units - centre) / 100);
    sum += miss * miss;
  }
  return std::sqrt(sum / static_cast<double>(points.size()));
}

std::pair<double, double> measured_range(const CalibrationData& data) {
  const auto [low, high] = std::minmax_element(data.points.begin(), data.points.end(),
                                               [](const auto& a, const auto& b) { return a.units < b.units; });
  return {low->units, high->units};
}

bool turns_back(const CalibrationFit& fit, const CalibrationData& data) {
  const auto [low, high] = measured_range(data);
  const double way = fit.at(high) - fit.at(low);
  for (double units = low; units + 1 <= high; ++units) {
    if ((fit.at(units + 1) - fit.at(units)) * way <= 0) {
      return true;
    }
  }
  return false;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != '\r' && c != '"' && !(c == ' ' && cells.back().empty())) {
      cells.back() += c;
    }
  }
  return cells;
}

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return is_number ? std::optional(value) : std::nullopt;
}

/// Positions of the columns in the file; npos where there is none.
struct Columns {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::size_t joint = kNone, position = kNone, angle = kNone, wall = kNone, offset = kNone;

  explicit Columns(const std::vector<std::string>& header) {
    for (std::size_t i = 0; i < header.size(); ++i) {
      for (const auto& [name, column] : {std::pair{"joint", &joint},
                                         {"servo_position", &position},
                                         {"angle_deg", &angle},
                                         {"wall_distance_cm", &wall},
                                         {"offset_added_cm", &offset}}) {
        *column = header[i] == name ? i : *column;
      }
    }
  }
};

double angle_deg(const std::string& joint, double wall_cm, const CalibrationOptions& options) {
  const double eye_cm = joint == "left_eye_pan"    ? -options.eye_half_baseline_cm
                        : joint == "right_eye_pan" ? options.eye_half_baseline_cm
                                                   : 0;
  return std::atan2(wall_cm - eye_cm, options.wall_distance_cm) * 180 / std::numbers::pi;
}

}  // namespace

double CalibrationFit::at(double units) const {
  const Eigen::Map<const Eigen::VectorXd> coefficients(coefficients_deg.data(),
                                                       static_cast<Eigen::Index>(coefficients_deg.size()));
  return value_at(coefficients, (units - centre_units) / 100);
}

ReadCalibration read_calibration(const std::string& path, const CalibrationOptions& options) {
  ReadCalibration read;
  const ReadSource source = read_source(path);
  if (!source.ok) {
    read.error = source.error;
    return read;
  }
  std::istringstream file(source.file.bytes);
  std::string line;
  std::getline(file, line);
  const Columns columns(split(line));
  if (columns.joint == Columns::kNone || columns.position == Columns::kNone ||
      (columns.angle == Columns::kNone && columns.wall == Columns::kNone)) {
    read.error = fmt::format("{}:1: needs columns joint, servo_position, and angle_deg or wall_distance_cm", path);
    return read;
  }
  for (int at = 2; std::getline(file, line); ++at) {
    const std::vector<std::string> cells = split(line);
    if (cells.size() == 1 && cells[0].empty()) {
      continue;
    }
    const auto cell = [&](std::size_t column) {
      return column < cells.size() ? number_of(cells[column]) : std::nullopt;
    };
    const auto units = cell(columns.position);
    const bool has_angle = columns.angle != Columns::kNone;
    const auto place = cell(has_angle ? columns.angle : columns.wall);
    const auto offset = columns.offset == Columns::kNone ? std::optional(0.0) : cell(columns.offset);
    if (columns.joint >= cells.size() || !units || !place || !offset) {
      read.error = fmt::format("{}:{}: not a joint and its numbers: {}", path, at, line);
      return read;
    }
    const std::string& name = cells[columns.joint];
    const auto known =
        std::find_if(read.joints.begin(), read.joints.end(), [&](const auto& j) { return j.joint == name; });
    CalibrationData& joint = known != read.joints.end() ? *known : read.joints.emplace_back(CalibrationData{name, {}});
    joint.points.push_back({*units, has_angle ? *place : angle_deg(name, *place + *offset, options)});
  }
  return read;
}

CalibrationFit fit_calibration(const CalibrationData& data, const CalibrationOptions& options, std::string& error) {
  CalibrationFit fit;
  std::set<double> places;
  for (const CalibrationPoint& point : data.points) {
    places.insert(point.units);
  }
  // With a point left out there must be one place more than coefficients.
  const int most = std::min(kHighestDegree, static_cast<int>(places.size()) - 3);
  if (most < 1 || options.degree > static_cast<int>(places.size()) - 1) {
    error = fmt::format("{}: measured at {} place{}, too few to fit {}", data.joint, places.size(),
                        places.size() == 1 ? "" : "s",
                        options.degree > 0 ? fmt::format("a polynomial of degree {}", options.degree) : "a line");
    return fit;
  }
  const auto [low, high] = measured_range(data);
  fit.centre_units = low <= kServoCentre && kServoCentre <= high ? kServoCentre : (low + high) / 2;
  int best = 1;
  for (int degree = 1; degree <= most; ++degree) {
    fit.cross_rmse_deg.push_back(leave_one_out_rmse(data.points, fit.centre_units, degree));
    best = fit.cross_rmse_deg.back() < fit.cross_rmse_deg[static_cast<std::size_t>(best - 1)] ? degree : best;
  }
  const Eigen::VectorXd solution = solve(data.points, fit.centre_units, options.degree > 0 ? options.degree : best, -1);
  fit.coefficients_deg.assign(solution.begin(), solution.end());
  double sum = 0;
  for (const CalibrationPoint& point : data.points) {
    const double residual_deg = point.angle_deg - fit.at(point.units);
    fit.residuals_deg.push_back(residual_deg);
    fit.largest_deg = std::max(fit.largest_deg, std::abs(residual_deg));
    sum += residual_deg * residual_deg;
  }
  fit.rmse_deg = std::sqrt(sum / static_cast<double>(data.points.size()));
  if (turns_back(fit, data)) {
    error = fmt::format("{}: the fitted angle turns back between the places; look at the picture, or give --degree 1",
                        data.joint);
  }
  return fit;
}

void apply_calibration(const CalibrationFit& fit, const CalibrationData& data, ServoJoint& joint) {
  joint.direction = fit.coefficients_deg[1] < 0 ? -1 : 1;
  joint.home_units = fit.centre_units;
  joint.deg_per_unit = std::abs(fit.deg_per_unit());
  for (std::size_t k = 0; k < joint.bend_deg.size(); ++k) {
    joint.bend_deg[k] = k + 2 < fit.coefficients_deg.size() ? joint.direction * fit.coefficients_deg[k + 2] : 0;
  }
  const auto [low, high] = measured_range(data);
  joint.min_units = std::max(joint.min_units, static_cast<std::uint16_t>(std::ceil(low)));
  joint.max_units = std::min(joint.max_units, static_cast<std::uint16_t>(std::floor(high)));
}

std::string calibration_svg(const std::vector<CalibrationData>& data, const std::vector<CalibrationFit>& fits) {
  constexpr double kWidth = 1000, kPanel = 330, kTitle = 22, kFit = 190, kResidual = 110;
  SvgBody body;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double x = i % 2 == 0 ? 0 : kWidth / 2, y = kPanel * static_cast<double>(i / 2);
    Chart fit;
    Chart residual;
    fit.x.label = residual.x.label = "servo position (units)";
    fit.y.label = "angle (deg)";
    residual.y.label = "off (deg)";
    const auto [low, high] = measured_range(data[i]);
    fit.x.min = residual.x.min = low - 10;
    fit.x.max = residual.x.max = high + 10;
    Series line{SeriesKind::Line, "fit", "c1", {}, {}, 1.6, 1, false};
    for (int step = 0; step <= 100; ++step) {
      line.x.push_back(low + (high - low) * step / 100);
      line.y.push_back(fits[i].at(line.x.back()));
    }
    Series points{SeriesKind::Points, "measured", "c0", {}, {}, 3.5, 1, false};
    Series misses{SeriesKind::Points, "", "c0", {}, {}, 3.5, 1, false};
    for (std::size_t k = 0; k < data[i].points.size(); ++k) {
      points.x.push_back(data[i].points[k].units);
      points.y.push_back(data[i].points[k].angle_deg);
      misses.x.push_back(data[i].points[k].units);
      misses.y.push_back(fits[i].residuals_deg[k]);
    }
    residual.series = {{SeriesKind::Line, "", "c1", {low, high}, {0, 0}, 1.6, 1, false}, misses};
    residual.y.min_span = 1;
    fit.series = {line, points};
    body.text(x + 12, y + 16,
              fmt::format("{}: {:+.4f} deg a unit, degree {}, RMSE {:.2f} deg", data[i].joint, fits[i].deg_per_unit(),
                          fits[i].degree(), fits[i].rmse_deg),
              "b");
    draw_chart(body, fit, {x + 14, y + kTitle, kWidth / 2 - 34, kFit});
    draw_chart(body, residual, {x + 14, y + kTitle + kFit, kWidth / 2 - 34, kResidual});
  }
  const double rows = std::ceil(static_cast<double>(data.size()) / 2);
  return standalone_svg(body, kWidth, rows * kPanel, "Calibration: servo position against angle, and residuals");
}

}  // namespace tectum
