// Trials of the clinic, and what they show as named figures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/act/decoder.h"
#include "tools/analysis/saccades.h"
#include "tools/analysis/simulated_run.h"
#include "tools/analysis/statistics.h"
#include "tools/evaluate/clinic.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {
namespace {

constexpr double kSampleS = 0.002;
constexpr double kFarAwayM = 1e4;     // a dot that no camera sees
constexpr double kUsualWallM = 0.55;  // that the head's dot is meant for
constexpr std::array<const char*, kEyeCount> kEyeNames = {"left_eye", "right_eye"};
constexpr std::array<const char*, 4> kDirectionNames = {"left", "right", "up", "down"};

struct GazeDirection {
  bool is_vertical;
  double sign;
};
constexpr std::array<GazeDirection, 4> kDirections = {{{false, -1}, {false, 1}, {true, 1}, {true, -1}}};

std::array<AngleTrace, kEyeCount> commands_of(const SpikeImage& image, const Recording& recording) {
  std::array<AngleTrace, kEyeCount> commands;
  const double tick_s = static_cast<double>(recording.tick_ns) * 1e-9;
  const auto ticks_each = static_cast<std::uint64_t>(std::max(1.0, std::round(kSampleS / tick_s)));
  const auto samples = static_cast<std::size_t>(recording.duration_s / (tick_s * static_cast<double>(ticks_each)));
  Decoder decoder(image);
  std::vector<NeuronId> now;
  std::size_t next = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    for (std::uint64_t tick = k * ticks_each; tick < (k + 1) * ticks_each; ++tick) {
      now.clear();
      for (; next < recording.spikes.size() && recording.spikes[next].tick == tick; ++next) {
        now.push_back(NeuronId{recording.spikes[next].neuron});
      }
      decoder.tick(now);
    }
    std::array<double, kJointCount> joint_deg{};
    decoder.decode(joint_deg);
    const auto at = [&](Joint joint) { return joint_deg[static_cast<std::size_t>(joint)]; };
    for (AngleTrace& trace : commands) {
      trace.time_s.push_back(static_cast<double>(k * ticks_each) * tick_s);
    }
    commands[0].pan_deg.push_back(at(Joint::LeftEyePan));
    commands[0].tilt_deg.push_back(at(Joint::LeftEyeTilt));
    commands[1].pan_deg.push_back(at(Joint::RightEyePan));
    commands[1].tilt_deg.push_back(at(Joint::RightEyeTilt));
  }
  return commands;
}

/// One eye's trace along one direction.
class Course {
 public:
  Course(const AngleTrace& trace, GazeDirection direction, double ahead_deg)
      : trace_(trace), direction_(direction), ahead_deg_(ahead_deg) {}

  /// Mean over [from_s, to_s), positive in the direction.
  [[nodiscard]] double mean(double from_s, double to_s) const {
    const std::vector<double>& x = values();
    const std::size_t first = index(from_s);
    const std::size_t last = std::max(first + 1, index(to_s));
    double sum = 0;
    for (std::size_t k = first; k < last && k < x.size(); ++k) {
      sum += direction_.sign * (x[k] - ahead_deg_);
    }
    return sum / static_cast<double>(last - first);
  }
  /// Largest mean of `width_s` inside [from_s, to_s).
  [[nodiscard]] double farthest(double from_s, double to_s, double width_s) const {
    double most = mean(from_s, from_s + width_s);
    for (double at_s = from_s; at_s + width_s <= to_s; at_s += 0.01) {
      most = std::max(most, mean(at_s, at_s + width_s));
    }
    return most;
  }
  [[nodiscard]] double deviation(double from_s, double to_s) const {
    const std::vector<double>& x = values();
    const double middle = direction_.sign * mean(from_s, to_s) + ahead_deg_;
    double sum = 0;
    const std::size_t first = index(from_s);
    const std::size_t last = std::min(x.size(), index(to_s));
    for (std::size_t k = first; k < last; ++k) {
      sum += (x[k] - middle) * (x[k] - middle);
    }
    return last > first ? std::sqrt(sum / static_cast<double>(last - first)) : 0;
  }
  [[nodiscard]] double moved(const Saccade& s) const {
    const std::size_t axis = direction_.is_vertical ? 1 : 0;
    return direction_.sign * (s.to_deg[axis] - s.from_deg[axis]);
  }

 private:
  [[nodiscard]] const std::vector<double>& values() const {
    return direction_.is_vertical ? trace_.tilt_deg : trace_.pan_deg;
  }
  [[nodiscard]] std::size_t index(double time_s) const {
    return static_cast<std::size_t>(
        std::clamp(std::round(time_s / kSampleS), 0.0, static_cast<double>(trace_.time_s.size())));
  }

  const AngleTrace& trace_;
  GazeDirection direction_;
  double ahead_deg_;
};

double middle_of(const std::vector<double>& values) { return median(values); }

/// How far the dot lies in the direction.
double along(const ClinicStep& step, GazeDirection direction) {
  return direction.sign * (direction.is_vertical ? step.tilt_deg : step.pan_deg);
}

void measure_direction(const std::string& eye, const char* name, GazeDirection direction, const Course& course,
                       const std::vector<Saccade>& saccades, const std::vector<ClinicStep>& steps, Measures& found) {
  std::vector<double> reach, first_saccade, overshoot, peak;
  double count = 0, jumps = 0;
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const ClinicStep& step = steps[k];
    if (step.is_dark || along(step, direction) <= along(steps[k - 1], direction)) {
      continue;
    }
    jumps += 1;
    const bool is_outward = along(step, direction) > 0;
    std::optional<double> first;
    for (const Saccade& s : saccades) {
      const double moved_deg = course.moved(s);
      const bool is_along = moved_deg > 0.7 * s.amplitude_deg;
      if (s.onset_s < step.begin_s || s.onset_s >= step.begin_s + 0.8 || !is_along) {
        continue;
      }
      count += 1;
      peak.push_back(s.peak_velocity_deg_s);
      first = first ? first : moved_deg;
    }
    if (is_outward) {
      first_saccade.push_back(first.value_or(0));
      reach.push_back(course.farthest(step.begin_s, step.end_s, 0.1));
      overshoot.push_back(course.farthest(step.begin_s, step.begin_s + 0.5, 0.022) -
                          course.mean(step.end_s - 0.4, step.end_s));
    }
  }
  const auto key = [&](const char* what) { return fmt::format("{}.{}.{}", eye, what, name); };
  found[key("reach")] = reach.empty() ? 0 : *std::max_element(reach.begin(), reach.end());
  found[key("saccades")] = jumps > 0 ? count / jumps : 0;
  found[key("first_saccade")] = middle_of(first_saccade);
  found[key("overshoot")] = middle_of(overshoot);
  found[key("peak_velocity")] = middle_of(peak);
}

/// What an eye loses of its outward saccades when it should stay.
void measure_holding(const std::string& eye, const AngleTrace& trace, const std::vector<Saccade>& saccades,
                     Measures& found) {
  std::vector<double> lost;
  for (const Saccade& s : saccades) {
    const double moved_deg = s.to_deg[0] - s.from_deg[0];
    if (std::abs(moved_deg) < 3 || std::abs(moved_deg) < 0.7 * s.amplitude_deg) {
      continue;
    }
    const Course course(trace, {false, moved_deg > 0 ? 1.0 : -1.0}, s.from_deg[0]);
    const double reached_deg = course.farthest(s.onset_s, s.offset_s + 0.03, 0.01);
    lost.push_back(1 - course.mean(s.offset_s + 0.1, s.offset_s + 0.12) / reached_deg);
  }
  const double share = middle_of(lost);
  found[eye + ".lost"] = share;
  found[eye + ".drift_time"] = share <= 0.001   ? 100
                               : share >= 0.999 ? 0.0
                                                : std::min(100.0, -0.1 / std::log(1 - share));
}

}  // namespace

std::vector<ClinicStep> clinic_steps(const ClinicPlan& plan) {
  const double h = plan.jump_deg;
  const double v = plan.vertical_jump_deg;
  const std::array<std::array<double, 2>, 9> places = {
      {{0, 0}, {-h, 0}, {0, 0}, {h, 0}, {0, 0}, {0, v}, {0, 0}, {0, -v}, {0, 0}}};
  std::vector<ClinicStep> steps;
  double at_s = 0;
  const auto add = [&](double length_s, double pan_deg, double tilt_deg, bool is_dark) {
    steps.push_back({at_s, at_s + length_s, pan_deg, tilt_deg, is_dark});
    at_s += length_s;
  };
  add(1, 0, 0, false);  // the head's start
  for (int round = 0; round < 2; ++round) {
    for (const auto& place : places) {
      add(plan.dwell_s, place[0], place[1], false);
    }
  }
  add(plan.dwell_s, h, 0, false);
  add(plan.dark_s, h, 0, true);
  return steps;
}

ClinicTrial clinic_trial(const SpikeImage& image, const Protocol& protocol, const ClinicPlan& plan,
                         const std::function<void(double)>& progress) {
  const std::vector<ClinicStep> steps = clinic_steps(plan);
  double run_s = 0;  // of all runs so far
  const auto run = [&](double wall_m, double duration_s, std::vector<PathPoint> path) {
    SimulatedRunOptions options =
        trial_options(image, protocol, {0, protocol.camera_latency_frames.front()}, protocol.first_seed);
    options.head.geometry.wall_distance_m = wall_m;
    options.head.camera.dot_radius_m *= wall_m / kUsualWallM;  // as large to the eye on every wall
    options.head.scenario.kind = ScenarioKind::Path;
    options.head.scenario.path = std::move(path);
    options.duration_s = duration_s;
    options.keeps_spikes = true;
    RunObserver observer;
    if (progress) {
      observer.progress = [&](double done) {
        progress((run_s + done * duration_s) / (steps.back().end_s + plan.near_s));
      };
    }
    const Recording recording = run_simulated_head(image, options, observer);
    run_s += duration_s;
    return commands_of(image, recording);
  };
  std::vector<PathPoint> path;
  const auto on_wall = [&](double deg) { return protocol.wall_distance_m * std::tan(deg * std::numbers::pi / 180); };
  for (const ClinicStep& step : steps) {
    const std::array<double, 2> place = step.is_dark
                                            ? std::array<double, 2>{kFarAwayM, kFarAwayM}
                                            : std::array<double, 2>{on_wall(step.pan_deg), on_wall(step.tilt_deg)};
    path.push_back({step.begin_s, place});
    path.push_back({step.end_s, place});
  }
  ClinicTrial trial;
  trial.command = run(protocol.wall_distance_m, steps.back().end_s, path);
  trial.near = run(plan.near_wall_m, plan.near_s, {{0, {0, 0}}});
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    std::vector<double> ahead;
    for (std::size_t k = 1; k < steps.size(); ++k) {
      const ClinicStep& step = steps[k];
      if (!step.is_dark && step.pan_deg == 0 && step.tilt_deg == 0) {
        ahead.push_back(Course(trial.command[eye], {false, 1}, 0).mean(step.end_s - 0.4, step.end_s));
      }
    }
    trial.ahead_deg[eye] = middle_of(ahead);
  }
  return trial;
}

Measures clinic_measures(const ClinicTrial& trial, const ClinicTrial& whole, const ClinicPlan& plan) {
  Measures found;
  const std::vector<ClinicStep> steps = clinic_steps(plan);
  SaccadeOptions options;
  options.min_threshold_deg_s = 40;
  options.min_amplitude_deg = 1;
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    const std::string name = kEyeNames[eye];
    const AngleTrace& trace = trial.command[eye];
    const std::vector<Saccade> saccades = detect_saccades(trace, options);
    for (std::size_t d = 0; d < kDirections.size(); ++d) {
      const double ahead_deg = kDirections[d].is_vertical ? 0 : whole.ahead_deg[eye];
      const Course course(trace, kDirections[d], ahead_deg);
      measure_direction(name, kDirectionNames[d], kDirections[d], course, saccades, steps, found);
    }
    std::vector<double> ripple;
    for (std::size_t k = 1; k < steps.size(); ++k) {
      if (!steps[k].is_dark) {
        ripple.push_back(Course(trace, {false, 1}, 0).deviation(steps[k].end_s - 0.6, steps[k].end_s));
      }
    }
    found[name + ".ripple"] = middle_of(ripple);
    measure_holding(name, trace, saccades, found);
    const GazeDirection inward{false, eye == 0 ? 1.0 : -1.0};
    found[name + ".convergence"] =
        Course(trial.near[eye], inward, trial.ahead_deg[eye]).mean(plan.near_s - 1, plan.near_s);
  }
  return found;
}

}  // namespace tectum
