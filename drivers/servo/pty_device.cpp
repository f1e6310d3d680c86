#include "drivers/servo/pty_device.h"

#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <thread>

namespace tectum {
namespace {

constexpr TimeNs kSecondNs = 1'000'000'000;
constexpr TimeNs kIdleNs = kSecondNs / 5;
// Bytes this close go out together: one wake-up of the thread takes about as long.
constexpr TimeNs kGatherNs = 30'000;

}  // namespace

struct PtyDevice::Impl {
  Impl(EmulatedDevice& emulated, const PtyOptions& pty_options) : device(emulated), options(pty_options) {}
  ~Impl() {
    stop();
    if (wake >= 0) {
      ::close(wake);
    }
  }

  bool start(std::string& error);
  void stop();
  void run();
  void take_input();
  void give_output(TimeNs now);
  [[nodiscard]] TimeNs until_next_ns(TimeNs now);
  void note_baud();

  EmulatedDevice& device;
  PtyOptions options;
  std::mutex mutex;  // guards the device
  std::string terminal_path;
  int master = -1;
  int slave = -1;  // kept open, so that a host that closes the port does not end the terminal
  int wake = -1;
  std::atomic<bool> is_stopping = false;
  std::thread thread;
};

TimeNs PtyDevice::now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<TimeNs>(now.tv_sec) * kSecondNs + now.tv_nsec;
}

bool PtyDevice::Impl::start(std::string& error) {
  const auto fail = [&](const std::string& what) {
    error = what + ": " + std::strerror(errno);
    stop();
    return false;
  };
  if (wake < 0) {
    wake = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  }
  master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 128> name{};
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 || ptsname_r(master, name.data(), name.size()) != 0) {
    return fail("cannot make a pseudo-terminal");
  }
  terminal_path = name.data();
  slave = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios2 settings{};
  if (slave < 0 || ioctl(slave, TCGETS2, &settings) != 0) {
    return fail(terminal_path);
  }
  settings.c_iflag = settings.c_oflag = settings.c_lflag = 0;  // or it would echo until a host sets it
  if (ioctl(slave, TCSETS2, &settings) != 0) {
    return fail(terminal_path);
  }
  if (!options.link_path.empty()) {
    std::array<char, 8> probe{};
    // Only a link is replaced, never a file that somebody needs.
    if (readlink(options.link_path.c_str(), probe.data(), probe.size()) >= 0) {
      ::unlink(options.link_path.c_str());
    }
    if (symlink(terminal_path.c_str(), options.link_path.c_str()) != 0) {
      return fail(options.link_path);
    }
  }
  is_stopping = false;
  thread = std::thread([this] { run(); });
  return true;
}

void PtyDevice::Impl::stop() {
  if (thread.joinable()) {
    is_stopping = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t woken = ::write(wake, &one, sizeof one);
    thread.join();
    if (!options.link_path.empty()) {
      ::unlink(options.link_path.c_str());
    }
  }
  for (int* file : {&slave, &master}) {
    if (*file >= 0) {
      ::close(*file);
      *file = -1;
    }
  }
}

void PtyDevice::Impl::note_baud() {
  termios2 settings{};  // the terminal's: what the host has set
  if (ioctl(master, TCGETS2, &settings) == 0) {
    device.set_line_baud(settings.c_ospeed);
  }
}

void PtyDevice::Impl::take_input() {
  std::array<std::uint8_t, 512> bytes;
  const ssize_t got = ::read(master, bytes.data(), bytes.size());
  if (got > 0) {
    const std::lock_guard lock(mutex);
    note_baud();
    device.receive(now_ns(), std::span(bytes).first(static_cast<std::size_t>(got)));
  }
}

void PtyDevice::Impl::give_output(TimeNs now) {
  std::array<std::uint8_t, 512> bytes;
  std::size_t count = 0;
  {
    const std::lock_guard lock(mutex);
    count = device.transmit(options.has_timing ? now + kGatherNs : EmulatedDevice::kNever, bytes);
  }
  // A terminal whose host reads nothing is full at some time; what does not fit is lost, as on a wire.
  [[maybe_unused]] const ssize_t written = ::write(master, bytes.data(), count);
}

TimeNs PtyDevice::Impl::until_next_ns(TimeNs now) {
  const std::lock_guard lock(mutex);
  const TimeNs next = device.next_ns();
  if (next == EmulatedDevice::kNever) {
    return kIdleNs;
  }
  return options.has_timing ? std::clamp<TimeNs>(next - now, 0, kIdleNs) : 0;
}

void PtyDevice::Impl::run() {
  if (options.in_thread) {
    options.in_thread();
  }
  prctl(PR_SET_TIMERSLACK, 1UL);  // the default of 50 us is five bytes at 1 Mbps
  while (!is_stopping) {
    const TimeNs wait_ns = until_next_ns(now_ns());
    const timespec wait{static_cast<time_t>(wait_ns / kSecondNs), static_cast<long>(wait_ns % kSecondNs)};
    std::array<pollfd, 2> watched = {{{master, POLLIN, 0}, {wake, POLLIN, 0}}};
    ppoll(watched.data(), watched.size(), &wait, nullptr);
    if ((watched[0].revents & POLLIN) != 0) {
      take_input();
    }
    give_output(now_ns());
  }
  std::uint64_t woken = 0;
  [[maybe_unused]] const ssize_t drained = ::read(wake, &woken, sizeof woken);
}

PtyDevice::PtyDevice(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

PtyDevice::~PtyDevice() = default;

std::unique_ptr<PtyDevice> PtyDevice::open(EmulatedDevice& device, const PtyOptions& options, std::string& error) {
  auto opened = std::unique_ptr<PtyDevice>(new PtyDevice(std::make_unique<Impl>(device, options)));
  if (!opened->impl_->start(error)) {
    return nullptr;
  }
  return opened;
}

std::string PtyDevice::path() const {
  return impl_->options.link_path.empty() ? impl_->terminal_path : impl_->options.link_path;
}

void PtyDevice::unplug() { impl_->stop(); }

bool PtyDevice::plug_in(std::string& error) {
  impl_->stop();
  return impl_->start(error);
}

PtyDevice::Lock::Lock(PtyDevice& device) : device_(device) { device_.impl_->mutex.lock(); }

PtyDevice::Lock::~Lock() { device_.impl_->mutex.unlock(); }

}  // namespace tectum
