#include "tools/evaluate/recorded_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string_view>

#include "drivers/head/geometry.h"
#include "tools/analysis/statistics.h"
#include "tools/evaluate/trial_result.h"

namespace tectum {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kJumpM = 0.02;     // between two samples; a resting laser is found to within 5 mm
constexpr double kShortestS = 1;    // a hold; the laser's way to the next point takes up to 0.3 s
constexpr double kOnTheWayS = 0.5;  // after a jump, before the laser rests

enum Column : std::size_t { kTime, kLaserX, kLaserZ, kLeftX, kLeftZ, kRightX, kRightZ, kColumns };
constexpr std::array<std::string_view, kColumns> kColumnNames = {"t_s",      "laser_x_m", "laser_z_m", "left_x_m",
                                                                 "left_z_m", "right_x_m", "right_z_m"};
using Row = std::array<double, kColumns>;

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) {
      cell.remove_prefix(1);
    }
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '\r')) {
      cell.remove_suffix(1);
    }
    cells.push_back(cell);
    if (comma == std::string_view::npos) {
      return cells;
    }
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> number_of(std::string_view cell) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const bool is_number = error == std::errc{} && end == cell.data() + cell.size() && std::isfinite(value);
  return is_number ? std::optional(value) : std::nullopt;
}

/// Where each column is in a line; an error when one is missing.
std::string find_columns(std::string_view header, std::array<std::size_t, kColumns>& at) {
  const std::vector<std::string_view> names = cells_of(header);
  for (std::size_t c = 0; c < kColumns; ++c) {
    const auto found = std::find(names.begin(), names.end(), kColumnNames[c]);
    if (found == names.end()) {
      return fmt::format(":1: no column `{}` among `{}`", kColumnNames[c], fmt::join(names, "`, `"));
    }
    at[c] = static_cast<std::size_t>(found - names.begin());
  }
  return "";
}

/// Appends the row of a line; an error that begins with the line's number.
std::string read_row(std::string_view line, std::size_t line_number, const std::array<std::size_t, kColumns>& at,
                     std::vector<Row>& rows) {
  const std::vector<std::string_view> cells = cells_of(line);
  Row row{};
  for (std::size_t c = 0; c < kColumns; ++c) {
    if (at[c] >= cells.size()) {
      return fmt::format(":{}: {} cells, none for `{}`", line_number, cells.size(), kColumnNames[c]);
    }
    const std::optional<double> value = number_of(cells[at[c]]);
    if (!value) {
      return fmt::format(":{}: `{}` is `{}`, which is no number", line_number, kColumnNames[c], cells[at[c]]);
    }
    row[c] = *value;
  }
  if (!rows.empty() && row[kTime] <= rows.back()[kTime]) {
    return fmt::format(":{}: `t_s` is {:g} after {:g} in the line before", line_number, row[kTime], rows.back()[kTime]);
  }
  rows.push_back(row);
  return "";
}

std::string read_rows(std::string_view bytes, std::vector<Row>& rows) {
  std::array<std::size_t, kColumns> at{};
  for (std::size_t line_number = 1; !bytes.empty(); ++line_number) {
    const std::size_t end = bytes.find('\n');
    const std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
    const bool is_blank = line.find_first_not_of(" \t\r") == std::string_view::npos;
    if (line_number > 1 && is_blank) {
      continue;
    }
    std::string error = line_number == 1 ? find_columns(line, at) : read_row(line, line_number, at, rows);
    if (!error.empty()) {
      return error;
    }
  }
  return rows.empty() ? ": holds no rows" : "";
}

/// First row of each hold; row 0 begins the first.
std::vector<std::size_t> hold_starts(const std::vector<Row>& rows) {
  std::vector<std::size_t> starts = {0};
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double way_m = std::hypot(rows[k][kLaserX] - rows[k - 1][kLaserX], rows[k][kLaserZ] - rows[k - 1][kLaserZ]);
    if (way_m >= kJumpM && rows[k][kTime] - rows[starts.back()][kTime] >= kShortestS) {
      starts.push_back(k);
    }
  }
  return starts;
}

/// Where the laser rests, row by row: the median of its hold.
std::vector<std::array<double, 2>> resting_places(const std::vector<Row>& rows,
                                                  const std::vector<std::size_t>& starts) {
  std::vector<std::array<double, 2>> places(rows.size());
  for (std::size_t h = 0; h < starts.size(); ++h) {
    const std::size_t last = h + 1 < starts.size() ? starts[h + 1] : rows.size();
    std::vector<double> x_m, z_m;
    for (std::size_t k = starts[h]; k < last; ++k) {
      if (rows[k][kTime] - rows[starts[h]][kTime] >= kOnTheWayS || k + 1 == last) {
        x_m.push_back(rows[k][kLaserX]);
        z_m.push_back(rows[k][kLaserZ]);
      }
    }
    std::fill(places.begin() + static_cast<std::ptrdiff_t>(starts[h]),
              places.begin() + static_cast<std::ptrdiff_t>(last), std::array{median(x_m), median(z_m)});
  }
  return places;
}

struct Direction {
  double pan_rad = 0, tilt_rad = 0;
};

Direction direction_of(double right, double up, double forward) {
  return {std::atan2(right, forward), std::atan2(up, std::hypot(right, forward))};
}

/// Of a point on the wall, seen from an eye of a head at home.
Direction seen_from(std::size_t eye, const std::array<double, 2>& on_wall_m, double wall_distance_m) {
  const HeadGeometry geometry;
  const double eye_x_m = (eye == index_of(Eye::Left) ? -1 : 1) * geometry.eye_half_baseline_m;
  return direction_of(on_wall_m[0] - eye_x_m, on_wall_m[1], wall_distance_m - geometry.neck_tilt_to_eye_forward_m);
}

/// A direction in the frame of an eye whose optical axis points to `gaze`, tilt turning with pan as the head's joints
/// do.
Direction in_frame_of(const Direction& gaze, const Direction& seen) {
  const double right = std::cos(seen.tilt_rad) * std::sin(seen.pan_rad - gaze.pan_rad);
  const double forward = std::cos(seen.tilt_rad) * std::cos(seen.pan_rad - gaze.pan_rad);
  const double up = std::sin(seen.tilt_rad);
  return direction_of(right, up * std::cos(gaze.tilt_rad) - forward * std::sin(gaze.tilt_rad),
                      forward * std::cos(gaze.tilt_rad) + up * std::sin(gaze.tilt_rad));
}

EyeTruth eye_truth(std::size_t eye, const std::array<double, 2>& gaze_m, const std::array<double, 2>& laser_m,
                   const std::array<double, 2>& rest_m, double wall_distance_m) {
  const Direction gaze = seen_from(eye, gaze_m, wall_distance_m);
  const Direction rest = seen_from(eye, rest_m, wall_distance_m);
  const Direction error = in_frame_of(gaze, seen_from(eye, laser_m, wall_distance_m));
  return {.target_pan_deg = rest.pan_rad * kDegPerRad,
          .target_tilt_deg = rest.tilt_rad * kDegPerRad,
          .error_pan_deg = error.pan_rad * kDegPerRad,
          .error_tilt_deg = error.tilt_rad * kDegPerRad,
          .gaze_pan_deg = gaze.pan_rad * kDegPerRad,
          .gaze_tilt_deg = gaze.tilt_rad * kDegPerRad,
          .gaze_on_wall_m = gaze_m};
}

/// With the laser where it rests as the target, so that its jumps are steps; the errors are of where it was.
Recording recording_of(const std::vector<Row>& rows, const std::vector<std::array<double, 2>>& rest_m,
                       double wall_distance_m) {
  const auto [lowest, highest] =
      std::minmax_element(rest_m.begin(), rest_m.end(), [](const auto& a, const auto& b) { return a[1] < b[1]; });
  const double middle_z_m = ((*lowest)[1] + (*highest)[1]) / 2;
  Recording recording;
  recording.scenario = "recorded";
  recording.wall_distance_m = wall_distance_m;
  recording.duration_s = rows.back()[kTime] - rows.front()[kTime];
  recording.frame_period_ns =
      static_cast<TimeNs>(std::llround(1e9 * recording.duration_s / static_cast<double>(rows.size() - 1)));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto place = [&](Column x, Column z) { return std::array{rows[k][x], rows[k][z] - middle_z_m}; };
    const std::array<double, 2> rest = {rest_m[k][0], rest_m[k][1] - middle_z_m};
    RecordedFrame frame;
    frame.time_ns = static_cast<TimeNs>(std::llround(1e9 * rows[k][kTime]));
    frame.has_truth = true;
    frame.target_on_wall_m = rest;
    const std::array<double, 2> laser = place(kLaserX, kLaserZ);
    frame.eye[0] = eye_truth(0, place(kLeftX, kLeftZ), laser, rest, wall_distance_m);
    frame.eye[1] = eye_truth(1, place(kRightX, kRightZ), laser, rest, wall_distance_m);
    recording.frames.push_back(std::move(frame));
  }
  return recording;
}

/// The paper's measure of error takes the target from the wall, where `recording` has it at rest.
void count_true_laser_on_wall(const std::vector<Row>& rows, const std::vector<std::array<double, 2>>& rest_m,
                              const Recording& recording, TrackingMetrics& metrics) {
  Recording as_it_was = recording;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    as_it_was.frames[k].target_on_wall_m[0] += rows[k][kLaserX] - rest_m[k][0];
    as_it_was.frames[k].target_on_wall_m[1] += rows[k][kLaserZ] - rest_m[k][1];
  }
  const TrackingMetrics true_metrics = tracking_metrics(as_it_was);
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    metrics.eye[eye].pan.wall = true_metrics.eye[eye].pan.wall;
    metrics.eye[eye].tilt.wall = true_metrics.eye[eye].tilt.wall;
  }
}

}  // namespace

ReadRecordedHead read_recorded_text(const std::string& name, const std::string& bytes, double wall_distance_m) {
  std::vector<Row> rows;
  if (const std::string error = bytes.empty() ? ": is empty" : read_rows(bytes, rows); !error.empty()) {
    return {std::nullopt, name + error};
  }
  const std::vector<std::size_t> starts = hold_starts(rows);
  if (starts.size() < 2) {
    return {std::nullopt, fmt::format("{}: the laser never jumps in its {} rows (by {:g} m or more, {:g} s after the "
                                      "start)",
                                      name, rows.size(), kJumpM, kShortestS)};
  }
  const std::vector<std::array<double, 2>> rest_m = resting_places(rows, starts);
  Recording recording = recording_of(rows, rest_m, wall_distance_m);
  TrialResult trial = trial_result(recording);
  count_true_laser_on_wall(rows, rest_m, recording, trial.metrics);
  RecordedHead head{.path = name, .result = {}};
  head.result.trials = {std::move(trial)};
  head.result.first_trial = std::move(recording);
  summarize(head.result);
  return {std::move(head), ""};
}

ReadRecordedHead read_recorded_head(const std::string& path, double wall_distance_m) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    return {std::nullopt, fmt::format("cannot read {}", path)};
  }
  return read_recorded_text(path, bytes, wall_distance_m);
}

}  // namespace tectum
