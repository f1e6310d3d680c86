// A dot that jumps in depth, from the wall to a screen before it and back, straight ahead and off to the side.
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

constexpr double kHoldS = 3;
constexpr std::array<double, 3> kAsideDeg = {0, -12, 12};

struct Plan {
  double distance_m = 0, aside_deg = 0;
  std::vector<PathPoint> path;
  double nearer_s = 0, back_s = 0, duration_s = 0;
};

Plan plan_of(double distance_m, double aside_deg, double wall_m) {
  const PathPoint far{0, place_m(aside_deg, 0, wall_m), wall_m};
  const PathPoint near{0, place_m(aside_deg, 0, distance_m), distance_m};
  Plan plan{.distance_m = distance_m, .aside_deg = aside_deg, .path = {}};
  plan.nearer_s = kHoldS;
  plan.back_s = 2 * kHoldS;
  plan.duration_s = 3 * kHoldS;
  plan.path = {{0, far.at_m, wall_m},
               {plan.nearer_s, far.at_m, wall_m},
               {plan.nearer_s, near.at_m, distance_m},
               {plan.back_s, near.at_m, distance_m},
               {plan.back_s, far.at_m, wall_m}};
  return plan;
}

struct Answer {
  double demand_deg = 0, gain = 0, half_way_ms = 0, peak_deg_s = 0, conjugate_deg = 0, left_over_deg = 0;
  bool is_half_way = false;
};

/// Vergence is left pan minus right pan: positive where the axes cross before the head.
Answer answer_of(const Recording& recording, double at_s) {
  const AngleTrace left = gaze_trace(recording, Eye::Left), right = gaze_trace(recording, Eye::Right);
  const AngleTrace target_left = target_trace(recording, Eye::Left), target_right = target_trace(recording, Eye::Right);
  const auto vergence = [](const AngleTrace& l, const AngleTrace& r, double from_s, double to_s) {
    return mean_between(l, l.pan_deg, from_s, to_s) - mean_between(r, r.pan_deg, from_s, to_s);
  };
  const auto conjugate = [&](double from_s, double to_s) {
    return (mean_between(left, left.pan_deg, from_s, to_s) + mean_between(right, right.pan_deg, from_s, to_s)) / 2;
  };
  const double end_s = at_s + kHoldS;
  Answer answer;
  answer.demand_deg = vergence(target_left, target_right, at_s + 0.1, end_s) -
                      vergence(target_left, target_right, at_s - 0.5, at_s - 0.05);
  const double before_deg = vergence(left, right, at_s - 0.3, at_s);
  answer.gain = (vergence(left, right, end_s - 0.3, end_s) - before_deg) / answer.demand_deg;
  answer.left_over_deg =
      vergence(target_left, target_right, end_s - 0.3, end_s) - vergence(left, right, end_s - 0.3, end_s);
  const double rest_deg = conjugate(at_s - 0.3, at_s);
  constexpr double kWindowS = 0.1;
  double last_deg = before_deg;
  for (double t_s = at_s; t_s + kWindowS < end_s; t_s += 0.05) {
    const double now_deg = vergence(left, right, t_s, t_s + kWindowS);
    answer.peak_deg_s = std::max(answer.peak_deg_s, std::abs(now_deg - last_deg) / 0.05);
    last_deg = now_deg;
    if (!answer.is_half_way && (now_deg - before_deg) / answer.demand_deg > 0.5) {
      answer.is_half_way = true;
      answer.half_way_ms = 1000 * (t_s + kWindowS / 2 - at_s);
    }
    answer.conjugate_deg = std::max(answer.conjugate_deg, std::abs(conjugate(t_s, t_s + kWindowS) - rest_deg));
  }
  return answer;
}

MeasureRow row_of(const Plan& plan, bool is_nearer, const std::vector<Answer>& answers) {
  const auto middle = [&](double Answer::*field) {
    std::vector<double> values;
    for (const Answer& answer : answers) {
      values.push_back(answer.*field);
    }
    return std::optional<double>(median(values));
  };
  const bool arrives = std::all_of(answers.begin(), answers.end(), [](const Answer& a) { return a.is_half_way; });
  MeasureRow row;
  row.what =
      fmt::format("{} {:.2f} m, {:g} deg aside", is_nearer ? "to" : "back from", plan.distance_m, plan.aside_deg);
  row.values = {middle(&Answer::demand_deg),
                middle(&Answer::gain),
                arrives ? middle(&Answer::half_way_ms) : std::nullopt,
                middle(&Answer::peak_deg_s),
                middle(&Answer::conjugate_deg),
                middle(&Answer::left_over_deg)};
  return row;
}

Chart chart_of(const Recording& recording) {
  Chart chart;
  chart.description = "vergence that the dot asks for and vergence of the eyes, over time";
  chart.x = {.label = "time (s)", .min = {}, .max = {}};
  chart.y = {.label = "vergence (deg)", .min = {}, .max = {}};
  const auto add = [&](const AngleTrace& left, const AngleTrace& right, const char* name, const char* ink) {
    Series series{.kind = SeriesKind::Line, .name = name, .ink = ink, .x = left.time_s, .y = {}};
    for (std::size_t k = 0; k < left.time_s.size(); ++k) {
      series.y.push_back(left.pan_deg[k] - right.pan_deg[k]);
    }
    chart.series.push_back(std::move(series));
  };
  add(target_trace(recording, Eye::Left), target_trace(recording, Eye::Right), "dot", "target");
  add(gaze_trace(recording, Eye::Left), gaze_trace(recording, Eye::Right), "eyes", "left");
  return chart;
}

}  // namespace

MeasuredProtocol measure_vergence(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                  const std::function<void(double)>& progress) {
  std::vector<Plan> plans;
  for (const double aside_deg : kAsideDeg) {
    for (const double distance_m : protocol.movement.distances_m) {
      plans.push_back(plan_of(distance_m, aside_deg, protocol.wall_distance_m));
    }
  }
  const auto trials = static_cast<std::size_t>(protocol.trials);
  std::vector<std::vector<Answer>> nearer(plans.size()), back(plans.size());
  std::vector<Chart> charts(plans.size());
  std::vector<Job> jobs;
  for (std::size_t p = 0; p < plans.size(); ++p) {
    jobs.emplace_back([&, p](const std::function<void(double)>& report) {
      for (std::size_t trial = 0; trial < trials; ++trial) {
        SimulatedRunOptions options =
            trial_options(image, protocol, settings_of(protocol).front(), protocol.first_seed + trial);
        options.head.scenario.kind = ScenarioKind::Path;
        options.head.scenario.path = plans[p].path;
        options.duration_s = plans[p].duration_s;
        const MovementTrial moved = run_movement(image, options, report);
        nearer[p].push_back(answer_of(moved.recording, plans[p].nearer_s));
        back[p].push_back(answer_of(moved.recording, plans[p].back_s));
        if (trial == 0) {
          charts[p] = chart_of(moved.recording);
        }
      }
    });
  }
  run_jobs(jobs, threads, progress);
  MeasuredProtocol measures;
  MeasureTable table;
  table.title = fmt::format("vergence: the dot jumps between the wall at {:g} m and a nearer screen (medians)",
                            protocol.wall_distance_m);
  table.columns = {{"demand", "deg", 1}, {"gain", "", 2},         {"half way", "ms", 0},
                   {"peak", "deg/s", 0}, {"conjugate", "deg", 2}, {"left over", "deg", 2}};
  for (std::size_t p = 0; p < plans.size(); ++p) {
    table.rows.push_back(row_of(plans[p], true, nearer[p]));
    table.rows.push_back(row_of(plans[p], false, back[p]));
    measures.pictures.push_back(
        {fmt::format("{:.2f} m, {:g} deg aside", plans[p].distance_m, plans[p].aside_deg), "", charts[p]});
  }
  table.notes = {
      "gain: change after 3 s over demand; conjugate: how far the mean of both eyes was carried along; left over: "
      "demand not met at the end",
      "people: starts after 160 to 200 ms, 25 deg/s for disparity alone, 53 to 69 deg/s for 4 deg of change in depth"};
  measures.tables = {table};
  return measures;
}

}  // namespace tectum
