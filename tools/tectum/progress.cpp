#include "tools/tectum/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace tectum {
namespace {

constexpr std::chrono::milliseconds kQuiet{2000};
constexpr std::chrono::milliseconds kTerminalPeriod{100};
constexpr std::chrono::milliseconds kFilePeriod{10'000};
constexpr int kBarWidth = 24;

}  // namespace

Progress::Progress(std::ostream& err, std::string what)
    : err_(err),
      what_(std::move(what)),
      is_terminal_(&err == &std::cerr && isatty(STDERR_FILENO) == 1),
      next_(Clock::now() + kQuiet) {}

Progress::~Progress() {
  if (is_line_open_) {
    err_ << "\r\x1b[K" << std::flush;
  }
}

void Progress::update(double done, const std::string& detail) {
  const auto now = Clock::now();
  if (now < next_) {
    return;
  }
  next_ = now + (is_terminal_ ? kTerminalPeriod : kFilePeriod);
  const double share = std::clamp(done, 0.0, 1.0);
  const std::string tail = detail.empty() ? "" : ", " + detail;
  if (!is_terminal_) {
    err_ << fmt::format("{}: {:.0f} %{}\n", what_, share * 100, tail) << std::flush;
    return;
  }
  const auto filled = static_cast<std::size_t>(share * kBarWidth);
  err_ << fmt::format("\r\x1b[K{} [{}{}] {:3.0f} %{}", what_, std::string(filled, '#'),
                      std::string(kBarWidth - filled, '.'), share * 100, tail)
       << std::flush;
  is_line_open_ = true;
}

}  // namespace tectum
