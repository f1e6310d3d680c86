// Single keys from the terminal, without Enter, while it lives. Nothing when standard input is no terminal.
#pragma once

#include <termios.h>

namespace tectum {

class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  [[nodiscard]] bool is_there() const { return is_there_; }
  /// The next key that waits; 0 when none does.
  [[nodiscard]] char next();

 private:
  bool is_there_ = false;
  termios before_{};
};

}  // namespace tectum
