// One-retina images and painted frames.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/ports/frame.h"

namespace tectum {

/// An image that holds a retina and nothing else.
inline SpikeImage image_of_retina(RetinaRecord retina, const std::vector<FieldRecord>& fields) {
  struct Storage {
    std::vector<RetinaRecord> retinas;
    std::vector<FieldRecord> fields;
  };
  retina.first_field = 0;
  retina.field_count = static_cast<std::uint32_t>(fields.size());
  auto storage = std::make_shared<Storage>(Storage{{retina}, fields});
  SpikeImage image;
  image.retinas = storage->retinas;
  image.fields = storage->fields;
  image.storage = storage;
  return image;
}

/// A black picture to paint on, with rows padded so that a stride mistaken for the width shows.
struct Picture {
  int width_px, height_px;
  std::size_t stride_bytes;
  std::vector<std::uint8_t> bytes;

  Picture(int width, int height)
      : width_px(width),
        height_px(height),
        stride_bytes(3 * static_cast<std::size_t>(width) + 5),
        bytes(stride_bytes * static_cast<std::size_t>(height), 0) {}

  std::uint8_t* pixel(int x, int y) {
    return bytes.data() + static_cast<std::size_t>(y) * stride_bytes + 3 * static_cast<std::size_t>(x);
  }
  void paint(int x, int y, std::uint8_t blue, std::uint8_t green, std::uint8_t red) {
    std::uint8_t* at = pixel(x, y);
    at[0] = blue;
    at[1] = green;
    at[2] = red;
  }
  [[nodiscard]] Frame frame() const {
    return {.bgr = bytes.data(), .width_px = width_px, .height_px = height_px, .stride_bytes = stride_bytes};
  }
};

/// Fields of equal size that tile the reference frame, row by row.
inline std::vector<FieldRecord> grid_of_fields(int across, int down, float width, float height) {
  std::vector<FieldRecord> fields;
  const float w = width / static_cast<float>(across), h = height / static_cast<float>(down);
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      fields.push_back({fx * w, fy * h, (fx + 1) * w, (fy + 1) * h});
    }
  }
  return fields;
}

}  // namespace tectum
