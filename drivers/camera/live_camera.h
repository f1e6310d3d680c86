// A camera that is there now: its own thread waits for frames, the loop takes the newest one.
//
// What is not a picture is not passed on: a frame of another size, a black one, one that has been the same for too
// long. The loop then sees no new frame, and its guard does what it does for a silent camera. Each such fault is told
// once, and once when it is over.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/ports/camera.h"

namespace tectum {

/// Where the frames of one camera come from. Used by one thread.
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;
  /// Waits for the next frame, but not much longer than 100 ms: NoNewFrame then. The pixels stay until the next call.
  [[nodiscard]] virtual CameraStatus wait(Frame& out) = 0;
};

/// Null with one line in `error`.
using FrameSourceOpener = std::function<std::unique_ptr<FrameSource>(std::string& error)>;

/// In pixels; a width of 0 takes everything.
struct CropPx {
  int x = 0, y = 0, width = 0, height = 0;
};

struct LiveCameraOptions {
  std::string name = "camera";      // in messages: "left eye"
  int width_px = 0, height_px = 0;  // what every frame must have; 0: what the first one has
  CropPx crop;
  TimeNs frozen_after_ns = 0;  // 0: a picture may stay the same for ever
  int black_below = 0;         // a frame without one sample at or above this is black; 0: none is
  TimeNs silent_after_ns = 500'000'000;
  TimeNs reopen_every_ns = 500'000'000;
  std::function<void()> in_thread = {};  // called first in the capture thread: its priority; may be empty
};

struct CameraEvent {
  TimeNs at_ns = 0;
  std::string text;  // one line: "left eye: black picture; is the lens covered?"
};

struct LiveCameraCounters {
  std::uint64_t frames = 0;       // passed on
  std::uint64_t overwritten = 0;  // by a newer one before the loop took them
  std::uint64_t black = 0, frozen = 0, mis_sized = 0;
  std::uint64_t reopened = 0;
};

class LiveCamera final : public Camera {
 public:
  /// Starts the thread, which opens the source, and opens it again when it fails. Not real-time safe.
  LiveCamera(const LiveCameraOptions& options, FrameSourceOpener open);
  ~LiveCamera() override;

  /// Real-time safe. The pixels stay until the next call. Failed while there is no source; Ended when it is over.
  [[nodiscard]] CameraStatus read(TimeNs now_ns, Frame& out) noexcept override;

  /// When the newest frame was passed on; 0 before the first. Any thread.
  [[nodiscard]] TimeNs newest_at_ns() const noexcept;
  [[nodiscard]] LiveCameraCounters counters() const;
  [[nodiscard]] std::vector<CameraEvent> take_events();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
