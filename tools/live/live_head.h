// A head file, opened: its servos behind the driver, its eyes behind capture threads. Real or emulated is the file's
// business.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/live_camera.h"
#include "drivers/servo/servo_driver.h"
#include "tools/live/emulated_head.h"
#include "tools/live/head_file.h"

namespace tectum {

struct LiveEvent {
  TimeNs at_ns = 0;
  std::string text;
};

class LiveHead {
 public:
  /// `fifo_priority` is the loop's, for the threads around it; 0: none. `simulation` is the simulated head's, if the
  /// file has one; its geometry is the file's. Null with one line in `error` when something can never work; a device
  /// that is merely not there yet is waited for in the background.
  [[nodiscard]] static std::unique_ptr<LiveHead> open(const HeadFile& file, const SimHeadParams& simulation,
                                                      int fifo_priority, std::string& error);

  /// Until every joint is measured and an eye has sent a picture. One line that says what is missing after
  /// `timeout_ns`, else empty.
  [[nodiscard]] std::string wait_until_ready(TimeNs timeout_ns);

  [[nodiscard]] ServoDriver& servos() noexcept { return *servos_; }
  /// Null when the head has no such eye.
  [[nodiscard]] LiveCamera* eye(Eye eye) noexcept { return eyes_[static_cast<std::size_t>(eye)].get(); }
  /// Null on a real head.
  [[nodiscard]] EmulatedHead* emulated() noexcept { return emulated_.get(); }
  [[nodiscard]] const HeadFile& file() const noexcept { return file_; }

  /// What servos and cameras had to tell since the last call, by time.
  [[nodiscard]] std::vector<LiveEvent> take_events();

 private:
  explicit LiveHead(const HeadFile& file) : file_(file) {}
  [[nodiscard]] FrameSourceOpener source_of(const HeadCamera& camera, Eye eye);

  HeadFile file_;
  std::unique_ptr<EmulatedHead> emulated_;
  std::unique_ptr<ServoDriver> servos_;
  std::array<std::unique_ptr<LiveCamera>, kEyeCount> eyes_;
};

}  // namespace tectum
