// A small recording in which no two numbers are the same.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "runtime/record/recording.h"

namespace tectum {

inline Recording small_recording(std::size_t frame_count) {
  Recording r;
  r.circuit_name = "oculomotor";
  r.scenario = "step";
  r.seed = 42;
  r.image_checksum = 0x0123456789ABCDEFULL;
  r.tick_ns = 100'000;
  r.frame_period_ns = 22'222'222;
  r.wall_distance_m = 0.55;
  r.guard = {{1, 2, 3, 4, 5, 6}, 7, 8, 9, 10, 11, 12};
  r.image = {std::byte{1}, std::byte{2}, std::byte{3}};
  r.populations = {{"SC.left", "SC", 0, 3}, {"EBN.right", "", 3, 2}};
  r.retinas = {{"left_eye", Eye::Left, 39.5, 720, 480, {{0, 1, 2, 3}, {4, 5, 6, 7}}},
               {"right_eye", Eye::Right, 40.5, 360, 240, {{8, 9, 10, 11}}}};
  double next = 0.1;
  const auto fill = [&next](auto& values) {
    for (double& value : values) {
      value = next += 0.7;
    }
  };
  for (std::size_t k = 0; k < frame_count; ++k) {
    RecordedFrame f;
    f.tick = 222 * k;
    f.time_ns = r.frame_period_ns * static_cast<TimeNs>(k);
    f.captured_ns = {f.time_ns - 5, f.time_ns - 7};
    f.active_fields[0].assign(k % 3, static_cast<std::uint32_t>(k));
    f.active_fields[1].assign(k % 2, 9);
    fill(f.decoded_deg);
    fill(f.goal_deg);
    fill(f.position_deg);
    f.fresh_mask = static_cast<std::uint32_t>(k % 64);
    f.camera_age_ns = 1000 + static_cast<TimeNs>(k);
    f.request = static_cast<std::uint8_t>(k % 4);
    f.guard_state = static_cast<std::uint8_t>(k % 8);
    f.has_command = k % 3 != 0;
    f.late_ns = 17 + static_cast<TimeNs>(k);
    f.stage_ns = {1, 2, 3, 4, static_cast<TimeNs>(k)};
    f.has_truth = k % 2 == 1;
    if (f.has_truth) {
      fill(f.target_on_wall_m);
      for (EyeTruth& eye : f.eye) {
        eye = {next + 1, next + 2, next + 3, next + 4, next + 5, next + 6, {next + 7, next + 8}};
        next += 9;
      }
    }
    r.frames.push_back(f);
    r.positions.push_back({f.time_ns + 1, f.position_deg});
    r.spikes.push_back({f.tick + 3, static_cast<std::uint32_t>(k % 2)});
    r.spikes.push_back({f.tick + 3, 4});
    r.spikes.push_back({f.tick + 200, 2});
  }
  r.duration_s = static_cast<double>(frame_count) * 0.022;
  return r;
}

inline bool same_truth(const EyeTruth& a, const EyeTruth& b) {
  return a.target_pan_deg == b.target_pan_deg && a.target_tilt_deg == b.target_tilt_deg &&
         a.error_pan_deg == b.error_pan_deg && a.error_tilt_deg == b.error_tilt_deg &&
         a.gaze_pan_deg == b.gaze_pan_deg && a.gaze_tilt_deg == b.gaze_tilt_deg && a.gaze_on_wall_m == b.gaze_on_wall_m;
}

inline bool same_frame(const RecordedFrame& a, const RecordedFrame& b) {
  return a.tick == b.tick && a.time_ns == b.time_ns && a.captured_ns == b.captured_ns &&
         a.active_fields == b.active_fields && a.decoded_deg == b.decoded_deg && a.goal_deg == b.goal_deg &&
         a.position_deg == b.position_deg && a.fresh_mask == b.fresh_mask && a.camera_age_ns == b.camera_age_ns &&
         a.request == b.request && a.guard_state == b.guard_state && a.has_command == b.has_command &&
         a.late_ns == b.late_ns && a.stage_ns == b.stage_ns && a.has_truth == b.has_truth &&
         a.target_on_wall_m == b.target_on_wall_m && same_truth(a.eye[0], b.eye[0]) && same_truth(a.eye[1], b.eye[1]);
}

/// A file of this process that goes with its scope.
class ScratchPath {
 public:
  explicit ScratchPath(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("tectum-" + std::to_string(::getpid()) + "-" + name)) {}
  ScratchPath(const ScratchPath&) = delete;
  ScratchPath& operator=(const ScratchPath&) = delete;
  ~ScratchPath() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string str() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::string& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace tectum
