// A camera frame, as the retina sees it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tectum {

/// Nanoseconds since the start of the run (virtual time) or of the monotonic clock (real time).
using TimeNs = std::int64_t;

/// One image, 8 bits a channel, interleaved blue, green, red (OpenCV's order). The camera owns the
/// pixels; they stay until its next read.
struct Frame {
  const std::uint8_t* bgr = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::size_t stride_bytes = 0;
  TimeNs captured_ns = 0;      // when the light was integrated, not when it was delivered
  std::uint64_t sequence = 0;  // counts frames of this camera
};

}  // namespace tectum
