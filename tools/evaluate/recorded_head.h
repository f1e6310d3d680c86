// What the real head of 2022 did, from a file of its own, to stand beside what the simulated one does.
//
// A CSV file with a header line; columns in any order, others are passed over:
//
//   t_s                      time, ascending
//   laser_x_m, laser_z_m     the dot on the wall: right, up
//   left_x_m, left_z_m       where the left eye's optical axis meets the wall; right_x_m, right_z_m the right eye's
//
// x counts from straight ahead. z counts from anywhere: straight ahead is taken to lie half-way between the lowest and
// the highest place where the laser rests, as the protocol's points lie. Angles are seen from where the eyes are when
// the head is at home, as the file does not tell where the neck was.
//
// A laser that servos move needs a few frames for a jump and overshoots. RMSE counts its true place in each frame;
// jumps are where it begins to move, and the responses to them go to where it comes to rest.
#pragma once

#include <optional>
#include <string>

#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {

struct RecordedHead {
  std::string path;
  ControllerResult result;  // of one trial
};

struct ReadRecordedHead {
  std::optional<RecordedHead> head;
  std::string error;  // one line that names file, line and column; empty when there is a head
};

[[nodiscard]] ReadRecordedHead read_recorded_head(const std::string& path, double wall_distance_m);
/// `bytes` as if they were the file `name`.
[[nodiscard]] ReadRecordedHead read_recorded_text(const std::string& name, const std::string& bytes,
                                                  double wall_distance_m);

}  // namespace tectum
