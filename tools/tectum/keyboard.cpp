#include "tools/tectum/keyboard.h"

#include <poll.h>
#include <unistd.h>

namespace tectum {

Keyboard::Keyboard() {
  // A background job must not touch the terminal's settings: it would be stopped.
  if (isatty(STDIN_FILENO) == 0 || tcgetpgrp(STDIN_FILENO) != getpgrp() || tcgetattr(STDIN_FILENO, &before_) != 0) {
    return;
  }
  termios keys = before_;
  keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C stays a signal
  is_there_ = tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
}

Keyboard::~Keyboard() {
  if (is_there_) {
    tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
}

char Keyboard::next() {
  pollfd waiting{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (is_there_ && poll(&waiting, 1, 0) > 0 && read(STDIN_FILENO, &key, 1) == 1) {
    return key;
  }
  return 0;
}

}  // namespace tectum
