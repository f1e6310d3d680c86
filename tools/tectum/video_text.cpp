#include "tools/tectum/video_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tools/analysis/gaze_traces.h"

namespace tectum {
namespace {

struct Seen {
  double pan_deg = 0;
  double tilt_deg = 0;
};

std::map<TimeNs, Seen> seen_by_time(const Recording& recording, Eye eye) {
  const AngleTrace trace = seen_direction_trace(recording, eye);
  std::map<TimeNs, Seen> seen;
  std::size_t sample = 0;
  for (const RecordedFrame& frame : recording.frames) {
    if (frame.active_fields[static_cast<std::size_t>(eye)].empty() || sample >= trace.time_s.size()) {
      continue;
    }
    seen[frame.time_ns] = {trace.pan_deg[sample], trace.tilt_deg[sample]};
    ++sample;
  }
  return seen;
}

std::string eye_text(const RecordedFrame& frame, Eye eye, const std::map<TimeNs, Seen>& seen) {
  const std::size_t fields = frame.active_fields[static_cast<std::size_t>(eye)].size();
  const auto found = seen.find(frame.time_ns);
  if (fields == 0 || found == seen.end()) {
    return fmt::format("{:>24}", "nothing");
  }
  return fmt::format("{:>4} {:>+8.1f},{:>+6.1f} deg", fields, found->second.pan_deg, found->second.tilt_deg);
}

}  // namespace

std::string video_text(const Recording& recording, std::size_t max_lines) {
  std::string text =
      fmt::format("{:>6} {:>8}  {:>24} {:>24}  {:>15} {:>15} {:>15}\n", "frame", "time s", "left eye sees: fields,at",
                  "right eye sees", "left eye told", "right eye told", "neck told");
  const auto left = seen_by_time(recording, Eye::Left);
  const auto right = seen_by_time(recording, Eye::Right);
  const std::size_t frames = recording.frames.size();
  const std::size_t stride = max_lines == 0 ? 1 : std::max<std::size_t>(1, (frames + max_lines - 1) / max_lines);
  for (std::size_t i = 0; i < frames; i += stride) {
    const RecordedFrame& frame = recording.frames[i];
    const auto& goal = frame.goal_deg;
    text += fmt::format("{:>6} {:>8.3f}  {} {}  {:>+7.1f},{:>+7.1f} {:>+7.1f},{:>+7.1f} {:>+7.1f},{:>+7.1f}\n", i,
                        static_cast<double>(frame.time_ns) * 1e-9, eye_text(frame, Eye::Left, left),
                        eye_text(frame, Eye::Right, right), goal[0], goal[1], goal[2], goal[3], goal[4], goal[5]);
  }
  if (stride > 1) {
    text += fmt::format("every {}th of {} frames; --lines 0 prints all, --record writes all\n", stride, frames);
  }
  return text;
}

}  // namespace tectum
