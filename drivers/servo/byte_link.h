// A pipe of bytes to whatever is at the other end of the cable, and the clock that its deadlines are read from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/ports/frame.h"

namespace tectum {

enum class LinkRead : std::uint8_t {
  Bytes,     // at least one
  TimedOut,  // none until the deadline
  Gone,      // the port has vanished; this link never works again
};

class ByteLink {
 public:
  ByteLink() = default;
  ByteLink(const ByteLink&) = delete;
  ByteLink& operator=(const ByteLink&) = delete;
  virtual ~ByteLink() = default;

  /// All of it, or false: the port has vanished or does not take bytes any more.
  [[nodiscard]] virtual bool write(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// What is there, as soon as anything is. `count` says how much of `out` was filled.
  [[nodiscard]] virtual LinkRead read(std::span<std::uint8_t> out, std::size_t& count, TimeNs deadline_ns) noexcept = 0;
  /// Throws away what has come and was not read.
  virtual void discard_input() noexcept = 0;
  [[nodiscard]] virtual TimeNs now_ns() noexcept = 0;
  virtual void sleep_until(TimeNs when_ns) noexcept = 0;
};

}  // namespace tectum
