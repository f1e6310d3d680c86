#include "tools/diff/kinematics.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/saccades.h"
#include "tools/analysis/statistics.h"

namespace tectum {
namespace {

constexpr double kSettlingS = 0.2;  // of a part, until which nobody expects the eyes to be there
constexpr double kLastS = 0.1;

/// Eye and neck shafts added up: the direction of gaze for a neck near its middle.
AngleTrace shaft_trace(const Recording& recording, Eye eye) {
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

class RunMeasures {
 public:
  RunMeasures(const Recording& recording, const Battery& battery) : recording_(recording), battery_(battery) {}

  std::vector<KinematicFigure> run() {
    for (const Eye eye : {Eye::Left, Eye::Right}) {
      const AngleTrace trace = shaft_trace(recording_, eye);
      const std::vector<Saccade> saccades = detect_saccades(trace, {.min_amplitude_deg = 1});
      for (const BatteryPart& part : battery_.parts) {
        if (part.kind == PartKind::Fixation) {
          fixation(trace, part);
        } else if (part.kind == PartKind::Step) {
          step(trace, saccades, part);
        } else {
          pursuit(trace, part);
        }
      }
    }
    const auto always = [](const BatteryPart&) { return 0.0; };
    const auto settled = [](const BatteryPart& part) { return part.end_s - part.begin_s - kLastS; };
    const auto later = [](const BatteryPart&) { return kSettlingS; };
    return {{"fixation spread", "deg", mean_of(fixation_spread_deg_)},
            {"fixation error", "deg", error_deg(PartKind::Fixation, later)},
            {"saccade amplitude", "deg", mean_of(amplitude_deg_)},
            {"peak velocity", "deg/s", mean_of(peak_deg_s_)},
            {"saccade latency", "ms", mean_of(latency_ms_)},
            {"overshoot", "%", mean_of(overshoot_percent_)},
            {"settled error", "deg", error_deg(PartKind::Step, settled)},
            {"pursuit error", "deg", error_deg(PartKind::Pursuit, later)},
            {"pursuit gain", "", mean_of(pursuit_gain_)},
            {"tracking error", "deg", error_deg(std::nullopt, always)}};
  }

 private:
  static std::optional<double> mean_of(const std::vector<double>& sample) {
    return sample.empty() ? std::nullopt : std::optional(mean(sample));
  }

  static std::pair<std::size_t, std::size_t> between(const AngleTrace& trace, double begin_s, double end_s) {
    const auto at = [&](double time_s) {
      return static_cast<std::size_t>(std::lower_bound(trace.time_s.begin(), trace.time_s.end(), time_s) -
                                      trace.time_s.begin());
    };
    return {at(begin_s), at(end_s)};
  }

  void fixation(const AngleTrace& trace, const BatteryPart& part) {
    const auto [first, last] = between(trace, part.begin_s + kSettlingS, part.end_s);
    if (last < first + 2) {
      return;
    }
    double variance = 0;
    for (const std::vector<double>* angle_deg : {&trace.pan_deg, &trace.tilt_deg}) {
      const std::span<const double> part_deg(angle_deg->data() + first, last - first);
      const double middle = mean(part_deg);
      for (const double deg : part_deg) {
        variance += (deg - middle) * (deg - middle) / static_cast<double>(last - first);
      }
    }
    fixation_spread_deg_.push_back(std::sqrt(variance));
  }

  void step(const AngleTrace& trace, const std::vector<Saccade>& saccades, const BatteryPart& part) {
    for (const Saccade& saccade : saccades) {
      if (saccade.onset_s >= part.begin_s && saccade.onset_s < part.end_s) {
        amplitude_deg_.push_back(saccade.amplitude_deg);
        peak_deg_s_.push_back(saccade.peak_velocity_deg_s);
        latency_ms_.push_back((saccade.onset_s - part.begin_s) * 1e3);
        break;
      }
    }
    const auto [first, last] = between(trace, part.begin_s, part.end_s);
    const double way_pan = part.to_deg[0] - part.from_deg[0], way_tilt = part.to_deg[1] - part.from_deg[1];
    const double way = std::hypot(way_pan, way_tilt);
    if (last <= first || way <= 0) {
      return;
    }
    double farthest = 0;
    for (std::size_t k = first; k < last; ++k) {
      const double done =
          ((trace.pan_deg[k] - part.from_deg[0]) * way_pan + (trace.tilt_deg[k] - part.from_deg[1]) * way_tilt) / way;
      farthest = std::max(farthest, done);
    }
    overshoot_percent_.push_back(100 * std::max(0.0, farthest / way - 1));
  }

  void pursuit(const AngleTrace& trace, const BatteryPart& part) {
    const auto [first, last] = between(trace, part.begin_s + kSettlingS, part.end_s);
    const double target_deg_s = (part.to_deg[0] - part.from_deg[0]) / (part.end_s - part.begin_s);
    if (last < first + 2 || target_deg_s == 0) {
      return;
    }
    const std::span<const double> time_s(trace.time_s.data() + first, last - first);
    const std::span<const double> pan_deg(trace.pan_deg.data() + first, last - first);
    const double middle_s = mean(time_s), middle_deg = mean(pan_deg);
    double both = 0, square = 0;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
      both += (time_s[k] - middle_s) * (pan_deg[k] - middle_deg);
      square += (time_s[k] - middle_s) * (time_s[k] - middle_s);
    }
    pursuit_gain_.push_back(both / square / target_deg_s);
  }

  /// Over the parts of a kind, each from `skipped` seconds after its beginning on.
  std::optional<double> error_deg(std::optional<PartKind> kind,
                                  const std::function<double(const BatteryPart&)>& skipped) const {
    double squares = 0;
    std::size_t count = 0;
    for (const RecordedFrame& frame : recording_.frames) {
      const double time_s = static_cast<double>(frame.time_ns) * 1e-9;
      const bool is_in = std::any_of(battery_.parts.begin(), battery_.parts.end(), [&](const BatteryPart& part) {
        return (!kind || part.kind == *kind) && time_s >= part.begin_s + skipped(part) && time_s < part.end_s;
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
  const Battery& battery_;
  std::vector<double> fixation_spread_deg_, amplitude_deg_, peak_deg_s_, latency_ms_, overshoot_percent_, pursuit_gain_;
};

}  // namespace

std::vector<KinematicFigure> kinematics(const Recording& recording, const Battery& battery) {
  return RunMeasures(recording, battery).run();
}

}  // namespace tectum
