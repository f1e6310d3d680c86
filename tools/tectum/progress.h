// A progress line for work that takes longer than two seconds.
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace tectum {

/// Prints nothing for the first two seconds. Then, on a terminal, one line that is drawn over;
/// elsewhere a line every ten seconds. Erases its line when it goes.
class Progress {
 public:
  /// `what` reads as a sentence's start: "running oculomotor".
  Progress(std::ostream& err, std::string what);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// `done` in 0..1; `detail` follows the percentage. Cheap enough to call in a loop.
  void update(double done, const std::string& detail = {});

 private:
  using Clock = std::chrono::steady_clock;
  std::ostream& err_;
  std::string what_;
  bool is_terminal_;
  bool is_line_open_ = false;
  Clock::time_point next_;
};

}  // namespace tectum
