// Every circuit that ships is under test: circuits/*.test.json, which the area circuit_files runs.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "tools/circuit_tests/circuit_test.h"

using namespace tectum;
namespace fs = std::filesystem;

namespace {

const fs::path kCircuits = fs::path(TECTUM_SOURCE_DIR) / "circuits";

bool is_test_file(const fs::path& path) { return path.filename().string().ends_with(".test.json"); }

std::string plain(const fs::path& path) { return fs::weakly_canonical(path).string(); }

/// The circuits that some test of some file names, with what its expectations compare them to left out.
std::set<std::string> circuits_under_test() {
  std::set<std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kCircuits)) {
    if (!is_test_file(entry.path())) {
      continue;
    }
    const TestFile file = read_test_file(entry.path().string());
    CAPTURE(file.path);
    CHECK(file.error.empty());
    CHECK_FALSE(file.diagnostics.has_errors());
    for (const CircuitTest& test : file.tests) {
      CHECK_FALSE(test.expectations.empty());
      found.insert(plain(test.circuit));
    }
  }
  return found;
}

}  // namespace

TEST_CASE("every shipped circuit has a test, and every test names a circuit that ships") {
  const std::set<std::string> tested = circuits_under_test();
  REQUIRE_FALSE(tested.empty());
  for (const fs::directory_entry& entry : fs::directory_iterator(kCircuits)) {
    if (entry.path().extension() == ".json" && !is_test_file(entry.path())) {
      CAPTURE(entry.path().filename().string());
      CHECK_MESSAGE(tested.contains(plain(entry.path())), "no circuits/*.test.json names this circuit");
    }
  }
  for (const std::string& circuit : tested) {
    CHECK_MESSAGE(fs::exists(circuit), circuit);
  }
}
