// Runs tests of circuits side by side, and says of each expectation what was seen.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/circuit_tests/circuit_test.h"

namespace tectum {

struct SeedOutcome {
  std::uint64_t seed = 0;
  bool passes = false;
  std::optional<double> value;  // of a number; coherent
  std::string seen;             // "95.3 ms", "12 spikes, the first at 1.2 s"
};

struct ExpectationResult {
  bool passes = false;
  std::vector<SeedOutcome> seeds;
  std::string seen;              // the mean, or of the seed that misses by most
  std::uint64_t shown_seed = 0;  // the one to look at
};

enum class TestStatus { Passed, Failed, Broken };

struct TestResult {
  const CircuitTest* test = nullptr;
  TestStatus status = TestStatus::Passed;
  std::string problem;                          // Broken: why it could not run, as printed
  std::vector<ExpectationResult> expectations;  // as the test's; none when Broken
  double seconds = 0;                           // of all its runs, on one core
};

struct FileResult {
  const TestFile* file = nullptr;
  std::string problem;             // of the whole file, as printed
  std::vector<TestResult> tests;   // those that the filter lets through
  std::vector<std::string> notes;  // what --update wrote, a line each
  bool is_unreadable = false;      // the file, or a golden that cannot be written
};

struct TestRunOptions {
  std::string filter;  // a part of "FILE: NAME"; empty: all
  bool updates = false;
  unsigned threads = 0;
  std::function<void(double done)> progress;
};

/// In the order of the files and of the tests in them; the same whatever the number of threads. `files` must outlive
/// the results.
[[nodiscard]] std::vector<FileResult> run_tests(const std::vector<TestFile>& files, const TestRunOptions& options);

/// *.test.json of a folder and those below, sorted; a file stands for itself. Hidden folders are left out. One line in
/// `error` when a path is not there.
[[nodiscard]] std::vector<std::string> find_test_files(const std::vector<std::string>& paths, std::string& error);

/// `tectum run …` that shows one seed of a test.
[[nodiscard]] std::string look_command(const CircuitTest& test, std::uint64_t seed);

}  // namespace tectum
