// The recording of a real laser dot: where it is, where its dot truly is, and how well a retina sees it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/image/spike_image.h"

namespace tectum {

struct DotTruth {
  bool is_visible = false, has_drawn_box = false;
  float x_px = 0, y_px = 0;
};

/// The folder beside the checkout that holds laser_dot.avi and laser_dot_truth.csv; empty where they are absent.
[[nodiscard]] std::string laser_dot_folder();

[[nodiscard]] std::vector<DotTruth> read_dot_truth(const std::string& path);

/// Camera pixels to a retina's reference pixels.
struct CameraToReference {
  float reference_per_camera_px = 1;
  float crop_left_px = 0, crop_top_px = 0;  // camera pixels left of and above the reference frame
};

struct DotScore {
  int visible = 0, contained = 0, nothing_away = 0, both = 0, off = 0, silent = 0;

  /// Counts one frame. A field is away from the dot when it has no point within 6 camera pixels of the true position:
  /// the dot's radius of 3 px, its blur, and the half pixel that the truth is uncertain by.
  void add(const DotTruth& truth, std::span<const std::uint32_t> active, std::span<const FieldRecord> fields,
           const CameraToReference& map);
  [[nodiscard]] std::string text() const;
};

}  // namespace tectum
