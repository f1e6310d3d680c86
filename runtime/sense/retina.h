// From a camera frame to active receptive fields.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "runtime/image/load_image.h"
#include "runtime/ports/frame.h"

namespace tectum {

struct RetinaCounters {
  std::uint64_t frames = 0;
  std::uint64_t lit_pixels_last_frame = 0;
};

/// One eye's sheet of fields.
class Retina {
 public:
  /// Not real-time safe. `retina_index` into image.retinas.
  Retina(const SpikeImage& image, std::uint32_t retina_index);
  ~Retina();
  Retina(Retina&&) noexcept;
  Retina& operator=(Retina&&) noexcept;

  /// Prepares for a frame size. Not real-time safe: allocates. Returns false for a size under 8x8
  /// or over 8192x8192.
  [[nodiscard]] bool prepare(int width_px, int height_px);

  /// Evaluates all fields; `active()` holds the result. Real-time safe for the prepared size;
  /// false (and nothing active) for another size.
  [[nodiscard]] bool encode(const Frame& frame) noexcept;

  /// Indices (0..field_count-1) of the active fields, ascending.
  [[nodiscard]] std::span<const std::uint32_t> active() const noexcept;
  [[nodiscard]] const RetinaCounters& counters() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
