#include "tools/analysis/gaze_traces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace tectum {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kMinJumpDeg = 0.5;
constexpr double kJumpOverNeighbours = 4;

double seconds(TimeNs time_ns) { return static_cast<double>(time_ns) * 1e-9; }

void push(AngleTrace& trace, double time_s, double pan_deg, double tilt_deg) {
  trace.time_s.push_back(time_s);
  trace.pan_deg.push_back(pan_deg);
  trace.tilt_deg.push_back(tilt_deg);
}

std::size_t joint_of(Eye eye, Joint left, Joint right) {
  return static_cast<std::size_t>(eye == Eye::Left ? left : right);
}

/// Angle that the target moved through between two frames, seen from straight in front of the wall.
double target_step_deg(const Recording& recording, std::size_t frame) {
  const RecordedFrame& before = recording.frames[frame - 1];
  const RecordedFrame& now = recording.frames[frame];
  if (!before.has_truth || !now.has_truth) {
    return 0;
  }
  const double distance_m = recording.wall_distance_m > 0 ? recording.wall_distance_m : 1;
  const auto direction_deg = [&](double offset_m) { return std::atan2(offset_m, distance_m) * kDegPerRad; };
  return std::hypot(direction_deg(now.target_on_wall_m[0]) - direction_deg(before.target_on_wall_m[0]),
                    direction_deg(now.target_on_wall_m[1]) - direction_deg(before.target_on_wall_m[1]));
}

}  // namespace

AngleTrace gaze_trace(const Recording& recording, Eye eye) {
  const auto e = static_cast<std::size_t>(eye);
  const std::size_t pan = joint_of(eye, Joint::LeftEyePan, Joint::RightEyePan);
  const std::size_t tilt = joint_of(eye, Joint::LeftEyeTilt, Joint::RightEyeTilt);
  AngleTrace trace;
  for (const RecordedFrame& frame : recording.frames) {
    if (frame.has_truth) {
      push(trace, seconds(frame.time_ns), frame.eye[e].gaze_pan_deg, frame.eye[e].gaze_tilt_deg);
    } else {
      push(trace, seconds(frame.time_ns),
           frame.position_deg[pan] + frame.position_deg[static_cast<std::size_t>(Joint::NeckPan)],
           frame.position_deg[tilt] + frame.position_deg[static_cast<std::size_t>(Joint::NeckTilt)]);
    }
  }
  return trace;
}

AngleTrace sampled_gaze_trace(const Recording& recording, Eye eye) {
  const std::size_t pan = joint_of(eye, Joint::LeftEyePan, Joint::RightEyePan);
  const std::size_t tilt = joint_of(eye, Joint::LeftEyeTilt, Joint::RightEyeTilt);
  AngleTrace trace;
  for (const RecordedPositions& sample : recording.positions) {
    const auto& deg = sample.position_deg;
    push(trace, seconds(sample.time_ns), deg[pan] + deg[static_cast<std::size_t>(Joint::NeckPan)],
         deg[tilt] + deg[static_cast<std::size_t>(Joint::NeckTilt)]);
  }
  return trace;
}

AngleTrace target_trace(const Recording& recording, Eye eye) {
  const auto e = static_cast<std::size_t>(eye);
  AngleTrace trace;
  for (const RecordedFrame& frame : recording.frames) {
    if (frame.has_truth) {
      push(trace, seconds(frame.time_ns), frame.eye[e].target_pan_deg, frame.eye[e].target_tilt_deg);
    }
  }
  return trace;
}

AngleTrace error_trace(const Recording& recording, Eye eye) {
  const auto e = static_cast<std::size_t>(eye);
  AngleTrace trace;
  for (const RecordedFrame& frame : recording.frames) {
    if (frame.has_truth) {
      push(trace, seconds(frame.time_ns), frame.eye[e].error_pan_deg, frame.eye[e].error_tilt_deg);
    }
  }
  return trace;
}

AngleTrace neck_trace(const Recording& recording) {
  AngleTrace trace;
  for (const RecordedFrame& frame : recording.frames) {
    push(trace, seconds(frame.time_ns), frame.position_deg[static_cast<std::size_t>(Joint::NeckPan)],
         frame.position_deg[static_cast<std::size_t>(Joint::NeckTilt)]);
  }
  return trace;
}

AngleTrace seen_direction_trace(const Recording& recording, Eye eye) {
  AngleTrace trace;
  const auto retina = std::find_if(recording.retinas.begin(), recording.retinas.end(),
                                   [eye](const RecordedRetina& candidate) { return candidate.eye == eye; });
  if (retina == recording.retinas.end() || retina->frame_width == 0) {
    return trace;
  }
  const double half_width_px = retina->frame_width / 2.0;
  const double half_height_px = retina->frame_height / 2.0;
  const double focal_px = half_width_px / std::tan(retina->field_of_view_deg / 2.0 / kDegPerRad);
  for (const RecordedFrame& frame : recording.frames) {
    double x_px = 0;
    double y_px = 0;
    double count = 0;
    for (const std::uint32_t index : frame.active_fields[static_cast<std::size_t>(eye)]) {
      if (index < retina->fields.size()) {
        const FieldRecord& field = retina->fields[index];
        x_px += (static_cast<double>(field.x0) + static_cast<double>(field.x1)) / 2;
        y_px += (static_cast<double>(field.y0) + static_cast<double>(field.y1)) / 2;
        count += 1;
      }
    }
    if (count > 0) {
      push(trace, seconds(frame.time_ns), std::atan2(x_px / count - half_width_px, focal_px) * kDegPerRad,
           std::atan2(half_height_px - y_px / count, focal_px) * kDegPerRad);
    }
  }
  return trace;
}

std::vector<double> target_jump_times_s(const Recording& recording) {
  std::vector<double> step_deg(recording.frames.size(), 0.0);
  for (std::size_t k = 1; k < step_deg.size(); ++k) {
    step_deg[k] = target_step_deg(recording, k);
  }
  std::vector<double> times_s;
  for (std::size_t k = 1; k < step_deg.size(); ++k) {
    const double after_deg = k + 1 < step_deg.size() ? step_deg[k + 1] : 0;
    if (step_deg[k] >= kMinJumpDeg && step_deg[k] >= kJumpOverNeighbours * std::max(step_deg[k - 1], after_deg)) {
      times_s.push_back(seconds(recording.frames[k].time_ns));
    }
  }
  return times_s;
}

TimeRange time_range(const Recording& recording) {
  if (recording.frames.empty()) {
    return {0, recording.duration_s};
  }
  return {seconds(recording.frames.front().time_ns),
          seconds(recording.frames.back().time_ns + recording.frame_period_ns)};
}

bool has_truth(const Recording& recording) {
  return std::any_of(recording.frames.begin(), recording.frames.end(),
                     [](const RecordedFrame& frame) { return frame.has_truth; });
}

}  // namespace tectum
