// What a run of circuit tests found: for people, for programs, and for CI.
#pragma once

#include <string>
#include <vector>

#include "tools/circuit_tests/run_tests.h"

namespace tectum {

struct TestTotals {
  std::size_t passed = 0, failed = 0, broken = 0;
  bool is_trouble = false;  // a file could not be read, or has mistakes, or a golden could not be written
  [[nodiscard]] std::size_t all() const { return passed + failed + broken; }
};

[[nodiscard]] TestTotals totals_of(const std::vector<FileResult>& files);

/// Each failure with what was expected, what was seen, where that is written, and the command that shows it.
[[nodiscard]] std::string test_text(const std::vector<FileResult>& files, double seconds);
[[nodiscard]] std::string test_json(const std::vector<FileResult>& files);
/// JUnit's XML as CI systems read it: a suite for each file, seconds on one core.
[[nodiscard]] std::string junit_xml(const std::vector<FileResult>& files);

}  // namespace tectum
