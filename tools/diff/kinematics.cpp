#include "tools/diff/kinematics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>

#include "tools/analysis/saccades.h"
#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr double kSettlingS = 0.2;  // of a part, until which nobody expects the eyes to be there
constexpr double kLastS = 0.1;
constexpr double kSoonestS = 0.03;  // before an answer can come: a frame of 45 Hz, and the circuit
constexpr double kSmallestWayDeg = 2;

using Angles = std::array<double, 2>;  // pan, tilt

Angles at(const AngleTrace& trace, std::size_t k) { return {trace.pan_deg[k], trace.tilt_deg[k]}; }

/// Of samples within [begin, end).
std::pair<std::size_t, std::size_t> between(const AngleTrace& trace, double begin_s, double end_s) {
  const auto index = [&](double time_s) {
    return static_cast<std::size_t>(std::lower_bound(trace.time_s.begin(), trace.time_s.end(), time_s) -
                                    trace.time_s.begin());
  };
  return {index(begin_s), index(end_s)};
}

/// Straight between the samples; Needs: a sample.
Angles interpolated(const AngleTrace& trace, double time_s) {
  const auto after = static_cast<std::size_t>(std::lower_bound(trace.time_s.begin(), trace.time_s.end(), time_s) -
                                              trace.time_s.begin());
  if (after == 0 || after == trace.time_s.size()) {
    return at(trace, after == 0 ? 0 : after - 1);
  }
  const Angles before_deg = at(trace, after - 1), after_deg = at(trace, after);
  const double share = (time_s - trace.time_s[after - 1]) / (trace.time_s[after] - trace.time_s[after - 1]);
  return {before_deg[0] + share * (after_deg[0] - before_deg[0]),
          before_deg[1] + share * (after_deg[1] - before_deg[1])};
}

class RunMeasures {
 public:
  RunMeasures(const Recording& recording, const std::vector<RunPart>& parts) : recording_(recording), parts_(parts) {}

  std::vector<KinematicFigure> run() {
    for (const Eye eye : {Eye::Left, Eye::Right}) {
      const AngleTrace gaze = shaft_trace(recording_, eye), target = target_trace(recording_, eye);
      SaccadeOptions options = recording_.positions.empty()
                                   ? frame_rate_saccade_options(static_cast<double>(recording_.frame_period_ns) * 1e-9)
                                   : SaccadeOptions{};
      options.min_amplitude_deg = 1;
      const std::vector<Saccade> saccades = detect_saccades(gaze, options);
      for (const RunPart& part : parts_) {
        if (part.kind == PartKind::Fixation) {
          fixation(gaze, part);
        } else if (part.kind == PartKind::Step) {
          step(gaze, target, saccades, part);
        } else {
          pursuit(gaze, target, part);
        }
      }
    }
    const auto always = [](const RunPart&) { return 0.0; };
    const auto settled = [](const RunPart& part) { return part.end_s - part.begin_s - kLastS; };
    const auto later = [](const RunPart&) { return kSettlingS; };
    return {{"fixation spread", "deg", mean_of(fixation_spread_deg_)},
            {"fixation RMSE", "deg", error_deg(PartKind::Fixation, later)},
            {"saccade amplitude", "deg", mean_of(amplitude_deg_)},
            {"peak velocity", "deg/s", mean_of(peak_deg_s_)},
            {"saccade latency", "ms", mean_of(latency_ms_)},
            {"overshoot", "%", mean_of(overshoot_percent_)},
            {"settled RMSE", "deg", error_deg(PartKind::Step, settled)},
            {"pursuit RMSE", "deg", error_deg(PartKind::Pursuit, later)},
            {"pursuit gain", "", mean_of(pursuit_gain_)},
            {"RMSE", "deg", error_deg(std::nullopt, always)}};
  }

 private:
  static std::optional<double> mean_of(const std::vector<double>& sample) {
    return sample.empty() ? std::nullopt : std::optional(mean(sample));
  }

  void fixation(const AngleTrace& gaze, const RunPart& part) {
    const auto [first, last] = between(gaze, part.begin_s + kSettlingS, part.end_s);
    if (last < first + 2) {
      return;
    }
    double variance = 0;
    for (const std::vector<double>* angle_deg : {&gaze.pan_deg, &gaze.tilt_deg}) {
      const std::span<const double> part_deg(angle_deg->data() + first, last - first);
      const double middle = mean(part_deg);
      for (const double deg : part_deg) {
        variance += (deg - middle) * (deg - middle) / static_cast<double>(last - first);
      }
    }
    fixation_spread_deg_.push_back(std::sqrt(variance));
  }

  void step(const AngleTrace& gaze, const AngleTrace& target, const std::vector<Saccade>& saccades,
            const RunPart& part) {
    const auto [first, last] = between(gaze, part.begin_s, part.end_s);
    if (last <= first || target.time_s.empty()) {
      return;
    }
    const Angles from_deg = at(gaze, first);
    // In the middle of the part the target is surely where it stays.
    const Angles to_deg = interpolated(target, (part.begin_s + part.end_s) / 2);
    const Angles way_deg = {to_deg[0] - from_deg[0], to_deg[1] - from_deg[1]};
    const double way = std::hypot(way_deg[0], way_deg[1]);
    if (way < kSmallestWayDeg) {
      return;
    }
    const auto along = [&](const Angles& deg, const Angles& origin_deg) {
      return ((deg[0] - origin_deg[0]) * way_deg[0] + (deg[1] - origin_deg[1]) * way_deg[1]) / way;
    };
    double farthest = 0;
    for (std::size_t k = first; k < last; ++k) {
      farthest = std::max(farthest, along(at(gaze, k), from_deg));
    }
    overshoot_percent_.push_back(100 * std::max(0.0, farthest / way - 1));
    const auto answer = std::find_if(saccades.begin(), saccades.end(), [&](const Saccade& saccade) {
      return saccade.onset_s >= part.begin_s + kSoonestS && saccade.onset_s < part.end_s &&
             along(saccade.to_deg, saccade.from_deg) > saccade.amplitude_deg / 2;
    });
    if (answer != saccades.end()) {
      amplitude_deg_.push_back(answer->amplitude_deg);
      peak_deg_s_.push_back(answer->peak_velocity_deg_s);
      latency_ms_.push_back((answer->onset_s - part.begin_s) * 1e3);
    }
  }

  void pursuit(const AngleTrace& gaze, const AngleTrace& target, const RunPart& part) {
    const auto [first, last] = between(gaze, part.begin_s + kSettlingS, part.end_s);
    if (last < first + 2 || target.time_s.empty()) {
      return;
    }
    std::array<std::vector<double>, 2> eye_deg, target_deg;
    for (std::size_t k = first; k < last; ++k) {
      const Angles there = interpolated(target, gaze.time_s[k]), here = at(gaze, k);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        eye_deg[axis].push_back(here[axis]);
        target_deg[axis].push_back(there[axis]);
      }
    }
    double both = 0, square = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double eye_middle = mean(eye_deg[axis]), target_middle = mean(target_deg[axis]);
      for (std::size_t k = 0; k < eye_deg[axis].size(); ++k) {
        both += (eye_deg[axis][k] - eye_middle) * (target_deg[axis][k] - target_middle);
        square += (target_deg[axis][k] - target_middle) * (target_deg[axis][k] - target_middle);
      }
    }
    if (square > 0) {
      pursuit_gain_.push_back(both / square);
    }
  }

  /// Over the parts of a kind, each from `skipped` seconds after its beginning on; over every frame without a kind.
  std::optional<double> error_deg(std::optional<PartKind> kind,
                                  const std::function<double(const RunPart&)>& skipped) const {
    double squares = 0;
    std::size_t count = 0;
    for (const RecordedFrame& frame : recording_.frames) {
      const double time_s = static_cast<double>(frame.time_ns) * 1e-9;
      const bool is_in = !kind || std::any_of(parts_.begin(), parts_.end(), [&](const RunPart& part) {
        return part.kind == *kind && time_s >= part.begin_s + skipped(part) && time_s < part.end_s;
      });
      for (std::size_t e = 0; e < kEyeCount && is_in && frame.has_truth; ++e) {
        squares += frame.eye[e].error_pan_deg * frame.eye[e].error_pan_deg +
                   frame.eye[e].error_tilt_deg * frame.eye[e].error_tilt_deg;
        ++count;
      }
    }
    return count == 0 ? std::nullopt : std::optional(std::sqrt(squares / static_cast<double>(count)));
  }

  const Recording& recording_;
  const std::vector<RunPart>& parts_;
  std::vector<double> fixation_spread_deg_, amplitude_deg_, peak_deg_s_, latency_ms_, overshoot_percent_, pursuit_gain_;
};

}  // namespace

AngleTrace shaft_trace(const Recording& recording, Eye eye) {
  if (recording.positions.empty()) {
    return gaze_trace(recording, eye);
  }
  const bool is_left = eye == Eye::Left;
  const auto pan = static_cast<std::size_t>(is_left ? Joint::LeftEyePan : Joint::RightEyePan);
  const auto tilt = static_cast<std::size_t>(is_left ? Joint::LeftEyeTilt : Joint::RightEyeTilt);
  AngleTrace trace;
  for (const RecordedPositions& sample : recording.positions) {
    const auto& deg = sample.position_deg;
    trace.time_s.push_back(static_cast<double>(sample.time_ns) * 1e-9);
    trace.pan_deg.push_back(deg[pan] + deg[static_cast<std::size_t>(Joint::NeckPan)]);
    trace.tilt_deg.push_back(deg[tilt] + deg[static_cast<std::size_t>(Joint::NeckTilt)]);
  }
  return trace;
}

std::vector<KinematicFigure> kinematics(const Recording& recording, const std::vector<RunPart>& parts) {
  return RunMeasures(recording, parts).run();
}

}  // namespace tectum
