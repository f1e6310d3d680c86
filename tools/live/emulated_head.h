// The head without its hardware, in real time: emulated AX-12As on a pseudo-terminal turn the simulated head, and its
// eyes are exposed on the clock. From the serial port on inwards everything is what drives a real head.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "drivers/camera/live_camera.h"
#include "drivers/head/sim_head.h"
#include "drivers/servo/ax12_emulator.h"
#include "drivers/servo/emulated_arbotix.h"
#include "drivers/servo/pty_device.h"
#include "drivers/servo/servo_driver.h"

namespace tectum {

/// What an emulated eye can suffer from.
enum class EyeFault : std::uint8_t { None, Unplugged, Silent, Frozen, Black, WrongSize };

class EmulatedHead {
 public:
  /// `board` is Direct or ArbotixRos. `in_thread` is called first in the thread that is the hardware; may be empty.
  /// Null with one line in `error`.
  [[nodiscard]] static std::unique_ptr<EmulatedHead> open(const SimHeadParams& params, const ServoMap& map,
                                                          ServoLinkKind board, const std::function<void()>& in_thread,
                                                          std::string& error);
  ~EmulatedHead();

  /// The terminal to open.
  [[nodiscard]] std::string port() const;
  /// One eye's exposures, each as soon as it can be read. Outlived by the head.
  [[nodiscard]] FrameSourceOpener eye(Eye eye);
  void set_fault(Eye eye, EyeFault fault) noexcept;
  /// Plug, noise, servos; under with_device() what is behind the plug.
  [[nodiscard]] PtyDevice& plug() noexcept;
  [[nodiscard]] Ax12Emulator& bus() noexcept;

  /// Now. Waits for whoever draws a picture: not real-time safe.
  [[nodiscard]] HeadTruth truth();

  struct World;

 private:
  explicit EmulatedHead(std::unique_ptr<World> world);
  std::unique_ptr<World> world_;
};

}  // namespace tectum
