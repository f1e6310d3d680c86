#include "drivers/servo/serial_port.h"

#include <asm/termbits.h>  // termios2, which has any baud rate; <termios.h> cannot be included beside it
#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tectum {
namespace {

constexpr TimeNs kSecondNs = 1'000'000'000;
// A frame of 259 bytes takes 0.27 s at 9600 baud; a port that takes nothing for this long is stuck.
constexpr TimeNs kWriteTimeoutNs = kSecondNs;

timespec to_timespec(TimeNs ns) noexcept {
  ns = std::max<TimeNs>(ns, 0);
  return {static_cast<time_t>(ns / kSecondNs), static_cast<long>(ns % kSecondNs)};
}

TimeNs monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<TimeNs>(now.tv_sec) * kSecondNs + now.tv_nsec;
}

enum class Ready { Yes, TimedOut, Gone };

Ready wait_for(int file, short events, TimeNs deadline_ns) noexcept {
  for (;;) {
    pollfd wanted{file, events, 0};
    const timespec left = to_timespec(deadline_ns - monotonic_ns());
    const int count = ppoll(&wanted, 1, &left, nullptr);
    if (count > 0) {
      return (wanted.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0 ? Ready::Gone : Ready::Yes;
    }
    if (count == 0) {
      return Ready::TimedOut;
    }
    if (errno != EINTR) {
      return Ready::Gone;
    }
  }
}

bool set_raw(int file, std::uint32_t baud) noexcept {
  termios2 settings{};
  if (ioctl(file, TCGETS2, &settings) != 0) {
    return false;
  }
  settings.c_iflag = IGNPAR;  // no translation, no XON/XOFF, a framing error is skipped
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);  // 8N1, no modem lines
  settings.c_ispeed = baud;
  settings.c_ospeed = baud;
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  return ioctl(file, TCSETS2, &settings) == 0;
}

std::uint32_t baud_set(int file) noexcept {
  termios2 settings{};
  return ioctl(file, TCGETS2, &settings) == 0 ? settings.c_ospeed : 0;
}

bool set_low_latency(int file) noexcept {
  serial_struct settings{};
  if (ioctl(file, TIOCGSERIAL, &settings) != 0) {
    return false;
  }
  settings.flags |= ASYNC_LOW_LATENCY;
  return ioctl(file, TIOCSSERIAL, &settings) == 0;
}

std::string reason(const std::string& path) {
  switch (errno) {
    case ENOENT:
      return path + ": no such device; is the adapter plugged in?";
    case EACCES:
    case EPERM:
      return path + ": not permitted; add yourself to the group `dialout` and log in again";
    case EBUSY:
    case EWOULDBLOCK:
      return path + ": another program uses it";
    default:
      return path + ": " + std::strerror(errno);
  }
}

}  // namespace

std::unique_ptr<SerialPort> SerialPort::open(const std::string& path, std::uint32_t baud, std::string& error) {
  const int file = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) {
    error = reason(path);
    return nullptr;
  }
  auto port = std::unique_ptr<SerialPort>(new SerialPort(file));
  if (isatty(file) == 0) {
    error = path + ": not a serial device";
    return nullptr;
  }
  if (flock(file, LOCK_EX | LOCK_NB) != 0) {
    error = reason(path);
    return nullptr;
  }
  if (!set_raw(file, baud)) {
    error = path + ": does not take " + std::to_string(baud) + " baud";
    return nullptr;
  }
  // A driver may round to what its clock divides to; the servos tolerate 3 %.
  const double set = baud_set(file);
  if (set < 0.97 * baud || set > 1.03 * baud) {
    error = path + ": asked for " + std::to_string(baud) + " baud, got " + std::to_string(baud_set(file));
    return nullptr;
  }
  port->is_low_latency_ = set_low_latency(file);
  port->discard_input();
  return port;
}

SerialPort::~SerialPort() { ::close(file_); }

bool SerialPort::write(std::span<const std::uint8_t> bytes) noexcept {
  const TimeNs deadline_ns = monotonic_ns() + kWriteTimeoutNs;
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    } else if (written < 0 && errno != EAGAIN && errno != EINTR) {
      return false;
    } else if (wait_for(file_, POLLOUT, deadline_ns) != Ready::Yes) {
      return false;
    }
  }
  return true;
}

LinkRead SerialPort::read(std::span<std::uint8_t> out, std::size_t& count, TimeNs deadline_ns) noexcept {
  count = 0;
  for (;;) {
    const ssize_t got = ::read(file_, out.data(), out.size());
    if (got > 0) {
      count = static_cast<std::size_t>(got);
      return LinkRead::Bytes;
    }
    if (got < 0 && errno != EAGAIN && errno != EINTR) {
      return LinkRead::Gone;
    }
    // A raw terminal with VMIN 0 reads 0 bytes when there are none, but also when it has hung up; poll tells them
    // apart.
    switch (wait_for(file_, POLLIN, deadline_ns)) {
      case Ready::Yes:
        break;
      case Ready::TimedOut:
        return LinkRead::TimedOut;
      case Ready::Gone: {
        // Bytes that came before the other end hung up are still there.
        const ssize_t last = ::read(file_, out.data(), out.size());
        count = last > 0 ? static_cast<std::size_t>(last) : 0;
        return count > 0 ? LinkRead::Bytes : LinkRead::Gone;
      }
    }
  }
}

void SerialPort::discard_input() noexcept { ioctl(file_, TCFLSH, TCIFLUSH); }

TimeNs SerialPort::now_ns() noexcept { return monotonic_ns(); }

void SerialPort::sleep_until(TimeNs when_ns) noexcept {
  const timespec when = to_timespec(when_ns);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR) {
  }
}

}  // namespace tectum
