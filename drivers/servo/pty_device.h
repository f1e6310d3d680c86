// An emulated device on a pseudo-terminal, in real time, in its own thread: for a program that opens a serial port it
// is the adapter with everything behind it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "drivers/servo/emulated_device.h"

namespace tectum {

struct PtyOptions {
  std::string link_path;                 // a symbolic link to the terminal, made new at every plug_in(); empty for none
  bool has_timing = true;                // bytes leave when they are due; otherwise at once
  std::function<void()> in_thread = {};  // called first in the device's thread: its priority; may be empty
};

class PtyDevice {
 public:
  /// Null with one clear line in `error`. `device` outlives it, and is only to be touched under with_device().
  [[nodiscard]] static std::unique_ptr<PtyDevice> open(EmulatedDevice& device, const PtyOptions& options,
                                                       std::string& error);
  ~PtyDevice();

  /// What to open: the link, or else the terminal.
  [[nodiscard]] std::string path() const;

  /// The adapter's plug out: the host's reads and writes fail, and its path is gone.
  void unplug();
  [[nodiscard]] bool plug_in(std::string& error);

  /// CLOCK_MONOTONIC, which the device is run by.
  [[nodiscard]] static TimeNs now_ns() noexcept;

  /// Runs `change(now_ns)` while the device's thread waits.
  template <typename Change>
  void with_device(Change&& change) {
    const Lock lock(*this);
    change(now_ns());
  }

 private:
  struct Impl;
  class Lock {
   public:
    explicit Lock(PtyDevice& device);
    ~Lock();

   private:
    PtyDevice& device_;
  };
  explicit PtyDevice(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
