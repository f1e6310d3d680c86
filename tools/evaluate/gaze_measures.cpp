// How eyes and neck share a gaze shift. The cameras see 20 deg to either side, so that the dot goes out in strides that
// stay in view; what is measured is where eyes and neck have come to rest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/analysis/statistics.h"
#include "tools/evaluate/movement_trial.h"
#include "tools/evaluate/movements.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {
namespace {

constexpr double kStrideDeg = 12;
constexpr double kStrideS = 0.4;
constexpr double kRestS = 3;
constexpr double kWatchS = 0.5;  // at the end of the rest
constexpr double kLargestTiltDeg = 40;

struct Direction4 {
  const char* name;
  double pan, tilt;
};
constexpr std::array<Direction4, 4> kDirections = {{{"right", 1, 0}, {"left", -1, 0}, {"up", 0, 1}, {"down", 0, -1}}};

struct Plan {
  std::vector<PathPoint> path;
  double rest_end_s = 0, duration_s = 0;
};

Plan plan_of(double size_deg, const Direction4& direction, double wall_m) {
  const auto at = [&](double deg) { return place_m(deg * direction.pan, deg * direction.tilt, wall_m); };
  Plan plan;
  double now_s = 1;
  double last_deg = 0;
  plan.path.push_back({0, at(0), 0});
  const int strides = static_cast<int>(std::ceil(size_deg / kStrideDeg));
  for (int k = 1; k <= strides; ++k) {
    const double deg = size_deg * k / strides;
    plan.path.push_back({now_s, at(last_deg), 0});
    plan.path.push_back({now_s, at(deg), 0});
    last_deg = deg;
    now_s += kStrideS;
  }
  plan.rest_end_s = now_s + kRestS;
  plan.duration_s = plan.rest_end_s;
  return plan;
}

struct Answer {
  bool is_vertical = false;
  double size_deg = 0, gaze_deg = 0, eye_deg = 0, neck_deg = 0, error_deg = 0;
  double half_neck_s = 0;
};

Answer answer_of(const MovementTrial& trial, const Plan& plan, double size_deg, const Direction4& direction) {
  const double from_s = plan.rest_end_s - kWatchS;
  const bool is_vertical = direction.pan == 0;
  const double sign = is_vertical ? direction.tilt : direction.pan;
  const auto along = [&](const AngleTrace& trace) {
    return sign * mean_between(trace, is_vertical ? trace.tilt_deg : trace.pan_deg, from_s, plan.rest_end_s);
  };
  Answer answer{.is_vertical = is_vertical, .size_deg = size_deg};
  const AngleTrace neck = neck_trace(trial.recording);
  answer.neck_deg = along(neck);
  double error_deg = 0;
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    answer.eye_deg += along(trial.plant[static_cast<std::size_t>(eye)]) / 2;
    answer.gaze_deg += along(gaze_trace(trial.recording, eye)) / 2;
    const AngleTrace error = error_trace(trial.recording, eye);
    error_deg += std::hypot(mean_between(error, error.pan_deg, from_s, plan.rest_end_s),
                            mean_between(error, error.tilt_deg, from_s, plan.rest_end_s)) /
                 2;
  }
  answer.error_deg = error_deg;
  return answer;
}

double middle(const std::vector<Answer>& answers, double Answer::*field) {
  std::vector<double> values;
  for (const Answer& answer : answers) {
    values.push_back(answer.*field);
  }
  return median(values);
}

MeasureRow row_of(const std::string& what, const std::vector<Answer>& answers) {
  const double eye_deg = middle(answers, &Answer::eye_deg), neck_deg = middle(answers, &Answer::neck_deg);
  return {
      what,
      {middle(answers, &Answer::gaze_deg), eye_deg, neck_deg,
       100 * neck_deg / std::max(std::abs(eye_deg) + std::abs(neck_deg), 1e-9), middle(answers, &Answer::error_deg)}};
}

Chart chart_of(const MeasureTable& table, const std::vector<double>& sizes_deg, bool is_vertical) {
  Chart chart;
  chart.description = "what eyes and neck contribute, over the size of the gaze shift";
  chart.x = {.label = "gaze shift (deg)", .min = 0.0, .max = {}};
  chart.y = {.label = "contribution (deg)", .min = {}, .max = {}};
  chart.marks = {20};
  for (const auto& [name, ink, column] : {std::tuple{"eyes", "left", 1}, {"neck", "neck", 2}}) {
    Series series{.kind = SeriesKind::Line, .name = name, .ink = ink, .x = {}, .y = {}};
    std::size_t row = 0;
    for (const bool rows_are_vertical : {false, true}) {
      for (const double size_deg : sizes_deg) {
        if (rows_are_vertical && size_deg > kLargestTiltDeg) {
          continue;
        }
        if (rows_are_vertical == is_vertical) {
          series.x.push_back(size_deg);
          series.y.push_back(table.rows[row].values[static_cast<std::size_t>(column)].value_or(0));
        }
        ++row;
      }
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

MeasuredProtocol measure_gaze_shifts(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                     const std::function<void(double)>& progress) {
  struct Case {
    double size_deg;
    const Direction4* direction;
    std::vector<Answer> answers;
  };
  std::vector<Case> cases;
  for (const double size_deg : protocol.movement.sizes_deg) {
    for (const Direction4& direction : kDirections) {
      if (direction.pan != 0 || size_deg <= kLargestTiltDeg) {
        cases.push_back({size_deg, &direction, {}});
      }
    }
  }
  std::vector<Job> jobs;
  for (Case& each : cases) {
    jobs.emplace_back([&](const std::function<void(double)>& report) {
      const Plan plan = plan_of(each.size_deg, *each.direction, protocol.wall_distance_m);
      for (std::uint64_t trial = 0; trial < static_cast<std::uint64_t>(protocol.trials); ++trial) {
        SimulatedRunOptions options =
            trial_options(image, protocol, settings_of(protocol).front(), protocol.first_seed + trial);
        options.head.scenario.kind = ScenarioKind::Path;
        options.head.scenario.path = plan.path;
        options.duration_s = plan.duration_s;
        each.answers.push_back(answer_of(run_movement(image, options, report), plan, each.size_deg, *each.direction));
      }
    });
  }
  run_jobs(jobs, threads, progress);
  MeasureTable table;
  table.title = "gaze shifts with the neck free: where eyes and neck rest (medians, positive outwards)";
  table.columns = {
      {"gaze", "deg", 1}, {"eyes", "deg", 1}, {"neck", "deg", 1}, {"neck's share", "%", 0}, {"error", "deg", 2}};
  for (const bool is_vertical : {false, true}) {
    for (const double size_deg : protocol.movement.sizes_deg) {
      std::vector<Answer> answers;
      for (const Case& each : cases) {
        if (each.size_deg == size_deg && (each.direction->pan == 0) == is_vertical) {
          answers.insert(answers.end(), each.answers.begin(), each.answers.end());
        }
      }
      if (!answers.empty()) {
        table.rows.push_back(
            row_of(fmt::format("{:g} deg {}", size_deg, is_vertical ? "up or down" : "left or right"), answers));
      }
    }
  }
  table.notes = {fmt::format("the dot goes out in strides of at most {:g} deg, {:g} s each, and rests {:g} s",
                             kStrideDeg, kStrideS, kRestS),
                 "monkeys: the head adds nothing below 20 deg, then grows in line with the shift up to 90 deg, while "
                 "the eyes stop at "
                 "35 deg (Freedman & Sparks 1997)"};
  MeasuredProtocol measures;
  measures.pictures = {
      {"Eyes and neck, left and right", "The line marks 20 deg, below which a monkey's head stays still.",
       chart_of(table, protocol.movement.sizes_deg, false)},
      {"Eyes and neck, up and down", "", chart_of(table, protocol.movement.sizes_deg, true)}};
  measures.tables = {std::move(table)};
  return measures;
}

}  // namespace tectum
