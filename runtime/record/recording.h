// What a run leaves behind, in memory. Files: runtime/record/recording_file.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/ports/servo_command.h"

namespace tectum {

struct RecordedPopulation {
  std::string name;
  std::string nucleus;
  std::uint32_t first_neuron = 0;
  std::uint32_t size = 0;
};

struct RecordedRetina {
  std::string name;
  Eye eye = Eye::Left;
  double field_of_view_deg = 0;
  std::uint32_t frame_width = 0, frame_height = 0;  // reference pixels
  std::vector<FieldRecord> fields;
};

struct RecordedSpike {
  std::uint64_t tick = 0;
  std::uint32_t neuron = 0;
  friend bool operator==(const RecordedSpike&, const RecordedSpike&) = default;
};

/// Gaze error of one eye: direction of the target minus the optical axis, in the eye's own frame, degrees.
/// Known only where a simulated head tells (has_truth).
struct EyeTruth {
  double target_pan_deg = 0;  // target's direction seen from the eye, in the fixed head-base frame
  double target_tilt_deg = 0;
  double error_pan_deg = 0;   // positive: the target is to the right of the optical axis
  double error_tilt_deg = 0;  // positive: above
  double gaze_pan_deg = 0;    // optical axis in the fixed head-base frame (eye + neck)
  double gaze_tilt_deg = 0;
  std::array<double, 2> gaze_on_wall_m{};  // where the optical axis meets the wall: right, up
};

/// One turn of the loop: what each eye saw, what the servos were told, where they were.
struct RecordedFrame {
  std::uint64_t tick = 0;  // first tick run with this frame
  TimeNs time_ns = 0;      // when the loop took the frame
  std::array<TimeNs, kEyeCount> captured_ns{};
  std::array<std::vector<std::uint32_t>, kEyeCount> active_fields;  // of the retina of that eye
  std::array<double, kJointCount> decoded_deg{};                    // before the guard
  std::array<double, kJointCount> goal_deg{};                       // what the servos were told
  std::array<double, kJointCount> position_deg{};                   // what they measured at time_ns
  std::uint32_t fresh_mask = 0;      // joints measured since the frame before; bit = Joint
  TimeNs camera_age_ns = 0;          // of the newer eye's newest frame
  std::uint8_t request = 0;          // GuardRequest
  std::uint8_t guard_state = 0;      // GuardState that the guard went into
  bool has_command = false;          // goal_deg was handed to the servos
  TimeNs late_ns = 0;                // behind the schedule
  std::array<TimeNs, 5> stage_ns{};  // read, encode, step, decode, write; or zeros
  bool has_truth = false;
  std::array<double, 2> target_on_wall_m{};  // right, up; from the point straight ahead
  std::array<EyeTruth, kEyeCount> eye{};
};

/// The guard's settings that a replay needs; the same as GuardOptions.
struct RecordedGuard {
  std::array<double, kJointCount> neutral_deg{};
  double approach_speed_deg_s = 0, ease_speed_deg_s = 0;
  TimeNs hold_after_ns = 0, ease_after_ns = 0, servo_lost_after_ns = 0, max_step_ns = 0;
};

/// Joints between the frames, from a head that can be asked that often.
struct RecordedPositions {
  TimeNs time_ns = 0;
  std::array<double, kJointCount> position_deg{};
};

struct Recording {
  std::string circuit_name;
  std::string scenario;  // "step", "video", ...
  std::uint64_t seed = 0;
  std::uint64_t image_checksum = 0;
  std::uint64_t tick_ns = 0;
  TimeNs frame_period_ns = 0;
  double duration_s = 0;
  double wall_distance_m = 0;
  RecordedGuard guard;
  bool learns = false;           // weights changed while it ran
  std::vector<std::byte> image;  // the image file that ran, or nothing
  std::vector<RecordedPopulation> populations;
  std::vector<RecordedRetina> retinas;
  std::vector<RecordedFrame> frames;
  std::vector<RecordedSpike> spikes;  // ascending by (tick, neuron)
  std::vector<RecordedPositions> positions;
};

}  // namespace tectum
