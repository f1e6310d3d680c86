// From a camera frame to active receptive fields.
//
// The frame is cropped to its largest centred window of the retina's aspect; the crop spans the reference frame.
// Along each axis, a field that is at least one camera pixel wide has the pixels whose centres lie in it (half-open),
// so that fields which tile the reference frame share out the camera's pixels without overlap. A field narrower than
// a camera pixel (the fovea of a 720-pixel reference seen by a 240-pixel crop) has every pixel that it overlaps: a
// lit pixel then activates all the small fields under it, since the camera cannot tell them apart.
//
// A field is active when its lit pixels >= max(1, lit_share * its pixels), both counted in camera pixels. A field
// that lies outside the reference frame has no pixel and is never active.
//
// The time of a frame depends on its size and on how many rows have a lit pixel, not on how many fields there are
// under a pixel: lit pixels are counted once, into a table of sums over the strips between field boundaries, and
// each field reads its count at its four corners (summed-area table, Crow 1984, doi:10.1145/800031.808600).
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
