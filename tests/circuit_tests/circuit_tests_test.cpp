// Test files of circuits: how they are read, judged and reported. What the shipped ones say: `tectum test circuits`.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "compiler/diagnostics/render.h"
#include "tests/report/well_formed.h"
#include "tools/circuit_tests/golden_raster.h"
#include "tools/circuit_tests/judge.h"
#include "tools/circuit_tests/measures.h"
#include "tools/circuit_tests/test_report.h"

using namespace tectum;
namespace fs = std::filesystem;

namespace {

/// A test that expects `expect`.
TestFile file_expecting(const std::string& expect) {
  return read_test_text("a.test.json",
                        R"({ "tectum_test": 1, "circuit": "c.json", "tests": { "t": { "expect": )" + expect + " } } }");
}

std::optional<Bound> bound_of(const std::string& text) {
  const TestFile file = file_expecting(R"({ "saccade": { "amplitude": ")" + text + "\" } }");
  if (file.tests.empty() || file.tests[0].expectations.empty()) {
    return std::nullopt;
  }
  return file.tests[0].expectations[0].bound;
}

/// A folder of its own, gone at the end.
struct Folder {
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "tectum-tests-XXXXXX").string();
    path = mkdtemp(pattern.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(path / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  fs::path path;
};

constexpr const char* kCircuit = R"({
  "tectum": 1, "name": "hiss", "tick": "1 ms",
  "neurons": { "hiss": { "model": "poisson", "rate": "40 Hz" }, "n": { "model": "lif_exp" } },
  "populations": { "A": { "neuron": "hiss", "size": 50 }, "B": { "neuron": "n", "size": 4 } },
  "projections": { "ab": { "from": "A", "to": "B", "rule": "all_to_all", "weight": "0.1 nA", "delay": "1 ms" } }
})";

std::vector<FileResult> run_in(const Folder& folder, const std::vector<TestFile>& files, bool updates = false) {
  (void)folder;
  TestRunOptions options;
  options.updates = updates;
  options.threads = 2;
  return run_tests(files, options);
}

TestFile file_in(const Folder& folder, const std::string& tests) {
  folder.write("hiss.json", kCircuit);
  const std::string name = (folder.path / "hiss.test.json").string();
  return read_test_text(name, R"({ "tectum_test": 1, "circuit": "hiss.json",
    "scenario": { "kind": "hold", "duration": "1 s" }, "tests": )" +
                                  tests + "}");
}

}  // namespace

TEST_CASE("bounds are read as people write them") {
  CHECK(bound_of("< 10 deg")->holds(9.99));
  CHECK_FALSE(bound_of("< 10 deg")->holds(10));
  CHECK(bound_of("<= 10 deg")->holds(10));
  CHECK(bound_of("> 1 deg")->holds(1.01));
  for (const char* text :
       {"10 deg ± 1", "10 deg +- 1", "10 deg ± 10 %", "10 deg ± 1 deg", "9 to 11 deg", "9 deg to 11 deg"}) {
    CAPTURE(text);
    const std::optional<Bound> bound = bound_of(text);
    REQUIRE(bound.has_value());
    CHECK(bound->low == doctest::Approx(9));
    CHECK(bound->high == doctest::Approx(11));
    CHECK(bound->text == text);
  }
}

TEST_CASE("a bound that is none, of another dimension or upside down is told with its place") {
  for (const char* text : {"about 3", "< ", "< 3 ms", "11 to 9 deg", "± 3", "< 3 degs"}) {
    CAPTURE(text);
    const TestFile file = file_expecting(R"({ "saccade": { "amplitude": ")" + std::string(text) + "\" } }");
    CHECK(file.diagnostics.has_errors());
    CHECK(render_text(file.diagnostics, file.sources).find("a.test.json:1:") != std::string::npos);
  }
}

TEST_CASE("mistakes in a test file are told together, each once") {
  const TestFile file = read_test_text("a.test.json", R"({ "tectum_test": 1, "circuit": "c.json", "tests": {
    "a": { "scenario": { "kind": "jumps" }, "expect": { "saccade": { "latensy": "< 3 ms" } } },
    "b": { "seeds": { "most": "5..1" }, "expect": { "rate": { "OPN during saccade": "< 3 Hz" } } },
    "c": {}
  } })");
  const std::string text = render_text(file.diagnostics, file.sources);
  for (const char* part : {"unknown scenario `jumps`", "did you mean `jump`?", "unknown key `latensy`",
                           "unknown time `saccade`", "did you mean `saccades`?", "`5..1`", "`expect`"}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
  }
}

TEST_CASE("seeds, lesions, parameters and scenario are those of the file unless a test says otherwise") {
  const TestFile file = read_test_text("there/a.test.json", R"({ "tectum_test": 1, "circuit": "c.json",
    "lesions": ["OPN"], "parameters": { "g": "2 nA", "h": 1 }, "scenario": { "kind": "jump", "to": ["8 deg", "-3 deg"] },
    "seeds": { "most": "1..3" }, "tests": {
    "a": { "expect": { "rmse": "< 3 deg" } },
    "b": { "lesions": [], "parameters": { "g": "3 nA" }, "seeds": 7, "circuit": "/abs/d.json", "expect": { "eyes": "still" } } } })");
  REQUIRE_MESSAGE(!file.diagnostics.has_errors(), render_text(file.diagnostics, file.sources));
  REQUIRE(file.tests.size() == 2);
  const CircuitTest& a = file.tests[0];
  CHECK(a.circuit == "there/c.json");
  CHECK(a.lesions == std::vector<std::string>{"OPN"});
  CHECK(a.parameters == std::vector<std::string>{"g=2 nA", "h=1"});
  CHECK(a.world.to_deg == std::array{8.0, -3.0});
  CHECK(a.seeds.quantifier == Quantifier::Most);
  CHECK(a.seeds.values == std::vector<std::uint64_t>{1, 2, 3});
  const CircuitTest& b = file.tests[1];
  CHECK(b.circuit == "/abs/d.json");
  CHECK(b.lesions.empty());
  CHECK(b.parameters == std::vector<std::string>{"h=1", "g=3 nA"});
  CHECK(b.seeds.values == std::vector<std::uint64_t>{7});
  CHECK(look_command(a, 3) ==
        "tectum run there/c.json -p 'g=2 nA' -p h=1 --lesion OPN --scenario jump --to 8 -3 --duration " +
            std::to_string(static_cast<int>(a.world.duration_s)) + " --seed 3 --report out/look.html");
}

TEST_CASE("quantifiers: every seed, most of them, or their mean") {
  Expectation expectation;
  expectation.bound.high = 10;
  const std::vector<SeedOutcome> seeds = {
      {1, true, 8.0, "8"}, {2, false, 13.0, "13"}, {3, true, 6.0, "6"}, {4, false, 11.0, "11"}, {5, true, 7.0, "7"}};
  const ExpectationResult every = conclude(expectation, Quantifier::Every, seeds);
  CHECK_FALSE(every.passes);
  CHECK(every.shown_seed == 2);
  CHECK(every.seen == "13");
  CHECK(conclude(expectation, Quantifier::Most, seeds).passes);
  CHECK(conclude(expectation, Quantifier::Mean, seeds).passes);
  expectation.bound.high = 8.9;
  CHECK_FALSE(conclude(expectation, Quantifier::Mean, seeds).passes);
}

TEST_CASE("golden rasters differ by line, and say where first") {
  Recording recording;
  recording.tick_ns = 1'000'000;
  recording.duration_s = 1;
  recording.populations = {{"A", "", 0, 4}, {"B", "", 4, 100}};
  recording.spikes = {{3, 0}, {3, 1}, {3, 2}, {12, 4}, {500, 3}};
  for (std::uint32_t n = 0; n < 60; ++n) {
    recording.spikes.push_back({700, 4 + n});
  }
  const std::string golden = golden_raster(recording, {{0, 1}, 0, 1}, " --seed 1");
  CHECK(golden.find("3:0-2") != std::string::npos);
  CHECK(golden.find("#") != std::string::npos);
  CHECK_FALSE(compare_rasters(golden, golden).has_value());
  Recording moved = recording;
  moved.spikes[3].tick = 13;
  const auto change = compare_rasters(golden, golden_raster(moved, {{0, 1}, 0, 1}, " --seed 1"));
  REQUIRE(change.has_value());
  CHECK(change->first_place.find("10 ms") != std::string::npos);
  CHECK(change->first_place.find("B") != std::string::npos);
  moved = recording;
  moved.spikes.back().neuron += 30;  // among the many that are a checksum
  CHECK(compare_rasters(golden, golden_raster(moved, {{0, 1}, 0, 1}, " --seed 1")).has_value());
  CHECK_FALSE(compare_rasters(golden_raster(recording, {{0}, 0, 0.6}, ""), golden_raster(moved, {{0}, 0, 0.6}, ""))
                  .has_value());
}

TEST_CASE("a circuit's test runs it, and a failure says what was expected, what was seen, where, and how to look") {
  const Folder folder;
  const std::vector<TestFile> files = {file_in(folder, R"({
    "right": { "seeds": { "every": "1..3" }, "expect": { "rate": { "A": "40 Hz ± 5" } } },
    "wrong": { "expect": { "rate": { "A": "< 10 Hz" }, "silent": ["A"] } },
    "typo": { "expect": { "rate": { "AA": "< 10 Hz" } } }
  })")};
  const std::vector<FileResult> results = run_in(folder, files);
  REQUIRE(results.size() == 1);
  REQUIRE(results[0].tests.size() == 3);
  CHECK(results[0].tests[0].status == TestStatus::Passed);
  CHECK(results[0].tests[1].status == TestStatus::Failed);
  CHECK(results[0].tests[2].status == TestStatus::Broken);
  const std::string text = test_text(results, 1);
  for (const char* part : {"hiss.test.json:4:", "expected < 10 Hz, seen ", "look: tectum run ",
                           "unknown population `AA`", "did you mean `A`?", "1 of 3 tests pass, 1 fail, 1 cannot run"}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
  }
  const std::string xml = junit_xml(results);
  CHECK(first_markup_error(xml) == "");
  CHECK(xml.find("<testsuites tests=\"3\" failures=\"1\" errors=\"1\">") != std::string::npos);
  const TestTotals totals = totals_of(results);
  CHECK(totals.passed == 1);
  CHECK(totals.broken == 1);
}

TEST_CASE("results do not depend on the number of threads, and a filter takes a part") {
  const Folder folder;
  const std::vector<TestFile> files = {file_in(folder, R"({
    "a": { "seeds": { "mean": "1..5" }, "expect": { "rate": { "A": "1 Hz ± 0.1" } } },
    "b": { "expect": { "rate": { "B": "> 0 Hz" } } } })")};
  TestRunOptions one;
  one.threads = 1;
  TestRunOptions four;
  four.threads = 4;
  CHECK(run_tests(files, one)[0].tests[0].expectations[0].seen ==
        run_tests(files, four)[0].tests[0].expectations[0].seen);
  one.filter = ": b";
  CHECK(run_tests(files, one)[0].tests.size() == 1);
}

TEST_CASE("--update writes a golden raster, and says what changed when it writes it again") {
  const Folder folder;
  const std::string tests = R"({ "spikes": { "expect": { "raster": { "file": "golden/a.raster", "to": "0.2 s" } } } })";
  const std::vector<TestFile> files = {file_in(folder, tests)};
  CHECK(run_in(folder, files)[0].tests[0].status == TestStatus::Failed);
  const std::vector<FileResult> written = run_in(folder, files, true);
  CHECK(written[0].tests[0].status == TestStatus::Passed);
  REQUIRE(written[0].notes.size() == 1);
  CHECK(written[0].notes[0].find("new") != std::string::npos);
  CHECK(run_in(folder, files)[0].tests[0].status == TestStatus::Passed);
  const std::string before = folder.read("golden/a.raster");
  std::string circuit = kCircuit;
  circuit.replace(circuit.find("40 Hz"), 5, "41 Hz");
  folder.write("hiss.json", circuit);
  const std::vector<FileResult> changed = run_in(folder, files);
  CHECK(changed[0].tests[0].status == TestStatus::Failed);
  CHECK(test_text(changed, 1).find("lines differ, the first at") != std::string::npos);
  const std::vector<FileResult> again = run_in(folder, files, true);
  REQUIRE(again[0].notes.size() == 1);
  CHECK(again[0].notes[0].find("differ") != std::string::npos);
  CHECK(folder.read("golden/a.raster") != before);
}

TEST_CASE("two circuits are told to do the same, spike for spike or within an angle") {
  const Folder folder;
  folder.write("same.json", kCircuit);
  std::string circuit = kCircuit;
  circuit.replace(circuit.find("40 Hz"), 5, "41 Hz");
  folder.write("other.json", circuit);
  const std::vector<TestFile> files = {file_in(folder, R"({
    "same": { "expect": { "same_as": "same.json" } },
    "other": { "expect": { "same_as": "other.json" } },
    "as far as the eyes go": { "expect": { "same_as": "other.json within 0.1 deg" } } })")};
  const std::vector<FileResult> results = run_in(folder, files);
  CHECK(results[0].tests[0].status == TestStatus::Passed);
  CHECK(results[0].tests[1].status == TestStatus::Failed);
  CHECK(results[0].tests[1].expectations[0].seen.find("A[") != std::string::npos);
  CHECK(results[0].tests[2].status == TestStatus::Passed);
}
