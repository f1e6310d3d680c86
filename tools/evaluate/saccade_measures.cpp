// Single steps of one size in eight directions: what the first saccade does, and what is left half a second later.
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

constexpr double kHoldS = 1.5;
constexpr double kGlideS = 1.5;           // to where an axis begins
constexpr double kWaitForSaccadeS = 0.6;  // a movement later than this answers something else
constexpr double kPlantNoiseDegS = 20;
constexpr std::array<std::array<double, 2>, 4> kAxes = {
    {{1, 0}, {0, 1}, {0.70710678, 0.70710678}, {0.70710678, -0.70710678}}};

struct Jump {
  double at_s = 0;
};

struct Plan {
  std::vector<PathPoint> path;
  std::vector<Jump> jumps;
  double duration_s = 0;
};

/// Across the middle and back, along four axes: eight directions.
Plan plan_of(double size_deg, double wall_m) {
  Plan plan;
  double now_s = kHoldS;
  plan.path.push_back({0, {0, 0}, 0});
  plan.path.push_back({now_s, {0, 0}, 0});
  for (const std::array<double, 2>& axis : kAxes) {
    const auto at = [&](double share) {
      return place_m(share * size_deg * axis[0], share * size_deg * axis[1], wall_m);
    };
    now_s += kGlideS;
    plan.path.push_back({now_s, at(-0.5), 0});
    for (const double share : {0.5, -0.5}) {
      now_s += kHoldS;
      plan.path.push_back({now_s, at(-share), 0});
      plan.path.push_back({now_s, at(share), 0});
      plan.jumps.push_back({now_s});
    }
    now_s += kHoldS;
    plan.path.push_back({now_s, at(-0.5), 0});
  }
  plan.duration_s = now_s;
  return plan;
}

struct Answer {
  bool has_saccade = false;
  double latency_ms = 0, gain = 0, direction_deg = 0, saccades = 0;
  double command_deg = 0, command_peak_deg_s = 0, command_ms = 0, skewness = 0;
  double plant_deg = 0, plant_peak_deg_s = 0, plant_ms = 0;
  double left_over_deg = 0;  // from 400 to 600 ms after the jump
};

const Saccade* first_after(const std::vector<Saccade>& saccades, double at_s) {
  for (const Saccade& saccade : saccades) {
    if (saccade.onset_s >= at_s && saccade.onset_s < at_s + kWaitForSaccadeS) {
      return &saccade;
    }
  }
  return nullptr;
}

std::vector<Answer> answers_of(const MovementTrial& trial, const Plan& plan) {
  SaccadeOptions options;  // six standard deviations of the noise of 200 motoneurons' spikes, and at least this
  options.min_threshold_deg_s = 40;
  options.min_amplitude_deg = 0.5;
  const std::vector<Saccade> commanded = detect_saccades(trial.eye[0], options);
  const std::vector<Saccade> moved = saccades_of(trial.plant[0], kPlantNoiseDegS);
  const AngleTrace target = target_trace(trial.recording, Eye::Left);
  const AngleTrace error = error_trace(trial.recording, Eye::Left);
  std::vector<Answer> answers;
  for (const Jump& jump : plan.jumps) {
    Answer answer;
    const double end_s = jump.at_s + kHoldS;
    const double pan_deg = mean_between(target, target.pan_deg, jump.at_s + 0.05, end_s - 0.05) -
                           mean_between(target, target.pan_deg, jump.at_s - 0.3, jump.at_s - 0.05);
    const double tilt_deg = mean_between(target, target.tilt_deg, jump.at_s + 0.05, end_s - 0.05) -
                            mean_between(target, target.tilt_deg, jump.at_s - 0.3, jump.at_s - 0.05);
    answer.left_over_deg = std::hypot(mean_between(error, error.pan_deg, jump.at_s + 0.4, jump.at_s + 0.6),
                                      mean_between(error, error.tilt_deg, jump.at_s + 0.4, jump.at_s + 0.6));
    if (const Saccade* s = first_after(commanded, jump.at_s)) {
      answer.has_saccade = true;
      answer.latency_ms = 1000 * (s->onset_s - jump.at_s);
      const double done_pan_deg = s->to_deg[0] - s->from_deg[0];
      const double done_tilt_deg = s->to_deg[1] - s->from_deg[1];
      answer.gain = (done_pan_deg * pan_deg + done_tilt_deg * tilt_deg) / (pan_deg * pan_deg + tilt_deg * tilt_deg);
      answer.direction_deg = std::abs(std::atan2(done_tilt_deg * pan_deg - done_pan_deg * tilt_deg,
                                                 done_pan_deg * pan_deg + done_tilt_deg * tilt_deg)) *
                             57.29577951;
      answer.command_deg = s->amplitude_deg;
      answer.command_peak_deg_s = s->peak_velocity_deg_s;
      answer.command_ms = 1000 * s->duration_s;
      answer.skewness = s->skewness;
    }
    if (const Saccade* s = first_after(moved, jump.at_s)) {
      answer.plant_deg = s->amplitude_deg;
      answer.plant_peak_deg_s = s->peak_velocity_deg_s;
      answer.plant_ms = 1000 * s->duration_s;
    }
    answer.saccades = static_cast<double>(std::count_if(commanded.begin(), commanded.end(), [&](const Saccade& s) {
      return s.onset_s >= jump.at_s && s.onset_s < end_s;
    }));
    answers.push_back(answer);
  }
  return answers;
}

MeasureRow row_of(double size_deg, const std::vector<Answer>& answers) {
  std::vector<Answer> made;
  std::copy_if(answers.begin(), answers.end(), std::back_inserter(made), [](const Answer& a) { return a.has_saccade; });
  const auto middle = [](const std::vector<Answer>& of, double Answer::*field) {
    std::vector<double> values;
    for (const Answer& answer : of) {
      values.push_back(answer.*field);
    }
    return values.empty() ? std::nullopt : std::optional<double>(median(values));
  };
  MeasureRow row;
  row.what = fmt::format("{:g} deg", size_deg);
  row.values = {static_cast<double>(answers.size()),
                answers.empty() ? std::nullopt
                                : std::optional<double>(100.0 * static_cast<double>(made.size()) /
                                                        static_cast<double>(answers.size())),
                middle(made, &Answer::latency_ms),
                middle(made, &Answer::gain),
                middle(made, &Answer::direction_deg),
                middle(made, &Answer::saccades),
                middle(made, &Answer::command_peak_deg_s),
                middle(made, &Answer::command_ms),
                middle(made, &Answer::skewness),
                middle(made, &Answer::plant_peak_deg_s),
                middle(made, &Answer::plant_ms),
                middle(answers, &Answer::left_over_deg)};
  return row;
}

Series points(const char* name, const char* ink, const std::vector<Answer>& answers, double Answer::*x,
              double Answer::*y) {
  Series series{.kind = SeriesKind::Points, .name = name, .ink = ink, .x = {}, .y = {}};
  for (const Answer& answer : answers) {
    if (answer.has_saccade && answer.*x > 0) {
      series.x.push_back(answer.*x);
      series.y.push_back(answer.*y);
    }
  }
  return series;
}

/// The edges of what was published, as two dashed lines.
template <typename Low, typename High>
void add_band(Chart& chart, const char* name, const Low& low, const High& high) {
  Series bottom{.kind = SeriesKind::Line, .name = name, .ink = "muted", .x = {}, .y = {}, .is_dashed = true};
  Series top = bottom;
  top.name.clear();
  for (double x = 0.5; x <= 40; x += 0.5) {
    bottom.x.push_back(x);
    bottom.y.push_back(low(x));
    top.x.push_back(x);
    top.y.push_back(high(x));
  }
  chart.series.push_back(std::move(bottom));
  chart.series.push_back(std::move(top));
}

std::vector<MeasurePicture> pictures_of(const std::vector<Answer>& all) {
  Chart peak;
  peak.description =
      "peak velocity over amplitude of every first saccade, of a human eye under the motoneurons and of the servos";
  peak.x = {.label = "amplitude (deg)", .min = 0.0, .max = {}};
  peak.y = {.label = "peak velocity (deg/s)", .min = 0.0, .max = {}};
  add_band(
      peak, "human, 700 (1 - exp(-A/7)) ± 20 %", [](double a) { return 0.8 * 700 * (1 - std::exp(-a / 7)); },
      [](double a) { return 1.2 * 700 * (1 - std::exp(-a / 7)); });
  peak.series.push_back(points("human eye", "left", all, &Answer::command_deg, &Answer::command_peak_deg_s));
  peak.series.push_back(points("servos", "right", all, &Answer::plant_deg, &Answer::plant_peak_deg_s));
  Chart duration;
  duration.description =
      "duration over amplitude of every first saccade, of a human eye under the motoneurons and of the servos";
  duration.x = peak.x;
  duration.y = {.label = "duration (ms)", .min = 0.0, .max = {}};
  add_band(
      duration, "human, 2.2 A + 21 to 2.7 A + 37 ms", [](double a) { return 2.2 * a + 21; },
      [](double a) { return 2.7 * a + 37; });
  duration.series.push_back(points("human eye", "left", all, &Answer::command_deg, &Answer::command_ms));
  duration.series.push_back(points("servos", "right", all, &Answer::plant_deg, &Answer::plant_ms));
  return {{"Main sequence",
           "The first saccade after each jump: what the motoneurons would do to a human eye, and what the servos do. "
           "Dashed: "
           "published range.",
           peak},
          {"Duration", "Dashed: two published fits.", duration}};
}

}  // namespace

MeasuredProtocol measure_saccades(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                  const std::function<void(double)>& progress) {
  const std::vector<double>& sizes_deg = protocol.movement.sizes_deg;
  const auto trials = static_cast<std::size_t>(protocol.trials);
  std::vector<std::vector<Answer>> answers(sizes_deg.size() * trials);
  std::vector<Job> jobs;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    jobs.emplace_back([&, k](const std::function<void(double)>& report) {
      const Plan plan = plan_of(sizes_deg[k / trials], protocol.wall_distance_m);
      SimulatedRunOptions options =
          trial_options(image, protocol, settings_of(protocol).front(), protocol.first_seed + k % trials);
      options.head.scenario.kind = ScenarioKind::Path;
      options.head.scenario.path = plan.path;
      options.duration_s = plan.duration_s;
      answers[k] = answers_of(run_movement(image, options, report), plan);
    });
  }
  run_jobs(jobs, threads, progress);
  MeasureTable table;
  table.title = "saccades: steps across the middle in eight directions (medians; left eye)";
  table.columns = {{"steps", "", 0},
                   {"with a saccade", "%", 0},
                   {"latency", "ms", 0},
                   {"gain", "", 2},
                   {"off direction", "deg", 1},
                   {"saccades", "a step", 1},
                   {"peak", "deg/s", 0},
                   {"lasts", "ms", 0},
                   {"peak at", "share", 2},
                   {"servo peak", "deg/s", 0},
                   {"servo lasts", "ms", 0},
                   {"left over", "deg", 2}};
  std::vector<Answer> all;
  for (std::size_t size = 0; size < sizes_deg.size(); ++size) {
    std::vector<Answer> of_size;
    for (std::size_t trial = 0; trial < trials; ++trial) {
      const std::vector<Answer>& one = answers[size * trials + trial];
      of_size.insert(of_size.end(), one.begin(), one.end());
    }
    table.rows.push_back(row_of(sizes_deg[size], of_size));
    all.insert(all.end(), of_size.begin(), of_size.end());
  }
  table.notes = {
      fmt::format("a step of more than {:.1f} deg along either axis leaves the square view of the eye and cannot be "
                  "answered",
                  image.retinas.empty() ? 0.0 : image.retinas.front().field_of_view_deg / 2),
      "latency, gain, direction, peak, lasts, peak at: of the first saccade within 600 ms that the motoneurons would "
      "give a "
      "human eye; servo: of the shafts; left over: error "
      "400 to 600 ms after the step"};
  return {{table}, pictures_of(all)};
}

}  // namespace tectum
