// From measured pairs of servo position and angle to a joint's map: polynomial least squares with cross-validation.
//
//   angle = sum over k of c[k] x^k,   x = (position - centre) / 100
//
// The centre is 512, the middle of an AX-12A, where the measured places reach over it, else the middle of the places.
//
// The degree is the one whose leave-one-out predictions are best, unless it is given. Every point is left out once, the
// rest fitted, the point predicted; a degree that only follows the noise predicts worse.
#pragma once

#include <string>
#include <vector>

#include "drivers/servo/servo_map.h"

namespace tectum {

inline constexpr int kHighestDegree = 4;  // as in the 2020 head's own program
inline constexpr double kServoCentre = 512;

struct CalibrationPoint {
  double units = 0;
  double angle_deg = 0;
};

struct CalibrationData {
  std::string joint;
  std::vector<CalibrationPoint> points;
};

struct CalibrationOptions {
  double wall_distance_cm = 55.3;   // between the joint's axis and the wall on which the places were measured
  double eye_half_baseline_cm = 0;  // eyes are this far left and right of the wall's zero; 0: angles from the middle
  int degree = 0;                   // 0: by cross-validation
};

struct ReadCalibration {
  std::vector<CalibrationData> joints;  // in the file's order
  std::string error;                    // one line, or empty
};
/// Columns joint, servo_position, and either angle_deg or wall_distance_cm with an optional offset_added_cm. Others are
/// ignored.
[[nodiscard]] ReadCalibration read_calibration(const std::string& path, const CalibrationOptions& options);

struct CalibrationFit {
  double centre_units = kServoCentre;
  std::vector<double> coefficients_deg;  // c[k]
  double rmse_deg = 0;                   // of the points
  double largest_deg = 0;                // residual's size
  std::vector<double> cross_rmse_deg;    // [d - 1]: leave-one-out, of degree d; as many as can be tried
  std::vector<double> residuals_deg;     // measured minus fitted, in the points' order
  [[nodiscard]] int degree() const { return static_cast<int>(coefficients_deg.size()) - 1; }
  [[nodiscard]] double at(double units) const;
  /// At the centre.
  [[nodiscard]] double deg_per_unit() const { return coefficients_deg[1] / 100; }
};

/// One line in `error` when there is nothing to fit: too few places, or the angle turns back between them.
[[nodiscard]] CalibrationFit fit_calibration(const CalibrationData& data, const CalibrationOptions& options,
                                             std::string& error);

/// Puts the fit into the joint: its angle is 0 at the centre, and its limits stay within what was measured.
void apply_calibration(const CalibrationFit& fit, const CalibrationData& data, ServoJoint& joint);

/// Points and fits above, residuals below, one panel a joint, as a whole SVG file.
[[nodiscard]] std::string calibration_svg(const std::vector<CalibrationData>& data,
                                          const std::vector<CalibrationFit>& fits);

}  // namespace tectum
