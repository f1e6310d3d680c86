#pragma once

#include <string>
#include <vector>

namespace tectum {

struct ProcessResult {
  int status = -1;  // as it exited; -1: it could not be started or was killed
  std::string out, err;
};

/// Runs a program that is looked for in PATH, with no input and no shell in between, and waits for it.
[[nodiscard]] ProcessResult run_process(const std::vector<std::string>& command);

}  // namespace tectum
