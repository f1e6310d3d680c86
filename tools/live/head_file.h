// A head file: which servos, cameras and cable a head has, where its joints are at home and how far they may turn.
//
// It is read with the circuit files' own machinery, so that a mistake in it is told with its place.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "compiler/diagnostics/diagnostic.h"
#include "drivers/camera/live_camera.h"
#include "drivers/head/geometry.h"
#include "drivers/servo/servo_driver.h"

namespace tectum {

inline constexpr int kHeadFileVersion = 1;
/// In the order of tectum::Joint.
inline constexpr std::array<const char*, kJointCount> kHeadJointNames = {
    "left_eye_pan", "left_eye_tilt", "right_eye_pan", "right_eye_tilt", "neck_pan", "neck_tilt"};

enum class CameraKind : std::uint8_t {
  Simulated,  // an eye of the simulated head
  Device,     // /dev/video0
  Video,      // a file, at its own pace
  None,
};

struct HeadCamera {
  CameraKind kind = CameraKind::None;
  std::string path;
  int width_px = 0, height_px = 0;  // 0: what the device offers
  double rate_hz = 0;
  double exposure = 0;       // of V4L2, in 0.1 ms; 0: automatic
  std::string pixel_format;  // of V4L2: "MJPG", "YUYV"; empty: the device's own
  CropPx crop;
  TimeNs frozen_after_ns = 0;
  int black_below = 0;
};

struct HeadFile {
  std::string name;
  bool is_emulated = false;  // servos on a pseudo-terminal, the simulated head behind them
  ServoLinkKind link = ServoLinkKind::Direct;
  std::string port;
  std::uint32_t baud = 0;  // 0: what the link comes with
  ServoMap map;
  std::array<double, kJointCount> neutral_deg{};
  std::array<HeadCamera, kEyeCount> cameras;
  HeadGeometry geometry;
};

struct ReadHead {
  std::optional<HeadFile> head;
  std::string error;     // one line when the file cannot be read; else empty
  std::string problems;  // what is wrong in it, as text for people
};
[[nodiscard]] ReadHead read_head_file(const std::string& path);
/// `bytes` as if they were the file `name`.
[[nodiscard]] ReadHead read_head_text(const std::string& name, const std::string& bytes);

/// The file's text again, with this map's joints in place of its own; everything else, comments too, stays as it was
/// written. Nothing when the text has no whole joints section.
[[nodiscard]] std::optional<std::string> with_joints(const std::string& text, const ServoMap& map,
                                                     const std::array<double, kJointCount>& neutral_deg);

}  // namespace tectum
