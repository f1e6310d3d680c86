// The head's servos as a ServoBus: a thread of its own talks to them, the loop hands over and takes the newest values.
//
// The thread sends a new command as soon as the question under way is answered, which at 1 Mbps takes about a third of
// a millisecond; in between it asks the servos, one round every round_ns. A turn of the loop begins with read() and
// ends with write(), so that after a read() no question is begun until the command is there, or hush_ns are over; and a
// question that went wrong is not repeated while a command waits. When the port vanishes it opens it again,
// twice a second, finds the servos anew and goes on. A joint that is lost, or limp after an alarm, is not fresh in the
// feedback, so that the guard holds it; goals go to it again once the loop has seen it fresh.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/servo/latency_histogram.h"
#include "drivers/servo/packet_exchange.h"
#include "drivers/servo/sketch_exchange.h"
#include "runtime/ports/servo_bus.h"

namespace tectum {

enum class ServoLinkKind : std::uint8_t {
  Direct,       // U2D2, USB2Dynamixel, USB2AX
  ArbotixRos,   // ArbotiX-M with the `ros` firmware
  ArbotixAscii  // ArbotiX-M with the 2020 head's own program
};
/// The rate that this kind of link comes with.
[[nodiscard]] std::uint32_t usual_baud(ServoLinkKind kind) noexcept;

struct ServoDriverOptions {
  ServoLinkKind kind = ServoLinkKind::Direct;
  ServoMap map;
  PacketExchangeOptions packets;  // the baud rate and the adapter are taken from `kind` and `baud`
  SketchExchangeOptions sketch;
  std::uint32_t baud = 0;  // 0 = usual_baud(kind)
  TimeNs round_ns = 10'000'000;
  TimeNs hush_ns = 3'000'000;
  TimeNs reopen_every_ns = 500'000'000;
  bool releases_at_end = true;           // torque off in stop()
  std::function<void()> in_thread = {};  // called first in the driver's thread: its priority; may be empty
};

/// Opens the port, or says why not.
using LinkOpener = std::function<std::unique_ptr<ByteLink>(std::string& error)>;
[[nodiscard]] LinkOpener serial_link(std::string path, std::uint32_t baud);

class ServoDriver final : public ServoBus {
 public:
  /// Starts the thread, which opens the port. Not real-time safe.
  ServoDriver(const ServoDriverOptions& options, LinkOpener open_link);
  /// stop().
  ~ServoDriver() override;

  /// The newest command wins; joints that it does not name keep their goals. False while there is no port. One thread
  /// calls this and read(). Real-time safe.
  [[nodiscard]] bool write(const ServoCommand& command) noexcept override;
  /// A joint is fresh when it works and was measured since the last call. Real-time safe.
  void read(TimeNs now_ns, ServoFeedback& out) noexcept override;

  /// Waits until every servo of the map has been measured. False after `timeout_ns`. Not real-time safe.
  [[nodiscard]] bool wait_until_ready(TimeNs timeout_ns);
  /// Torque off, if the options say so, and the end of the thread. Not real-time safe.
  void stop();

  /// Copies of what the thread knew after its last round. Any thread; not real-time safe.
  [[nodiscard]] HeadReport report() const;
  [[nodiscard]] std::vector<ServoEvent> take_events();
  /// From write() to the command's last byte being in the kernel's hands.
  [[nodiscard]] LatencyHistogram command_latency() const;
  /// The same from ServoCommand::issued_ns, for a loop on CLOCK_MONOTONIC.
  [[nodiscard]] LatencyHistogram issue_latency() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
