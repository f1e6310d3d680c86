// Tests of circuits as data: what NAME.test.json says. The language is described in circuits/README.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "tools/analysis/simulated_world.h"
#include "tools/circuit_tests/bound.h"

namespace tectum {

enum class Quantifier { Every, Most, Mean };

/// How many of the seeds have to pass, or whether it is their mean that has to.
struct Seeds {
  Quantifier quantifier = Quantifier::Every;
  std::vector<std::uint64_t> values = {1};
};

/// When a population's rate is taken. Movements are those of the motoneurons' command.
enum class RateTime { WholeRun, Fixation, Saccades };

enum class ExpectationKind { Measure, Rate, Silent, RunAway, Raster, SameAs };

struct Expectation {
  ExpectationKind kind = ExpectationKind::Measure;
  Span span;         // of what is expected: a bound, a name, a word
  Span name_span;    // of the population that it speaks of
  std::string what;  // "saccade latency", "rate of OPN during fixation"
  Bound bound;       // Measure, Rate; of SameAs the tolerance
  Dimension dimension;
  bool is_share = false;                 // a plain number that is written in %
  std::size_t measure = 0;               // Measure: index into measures()
  std::optional<std::size_t> channel;    // Measure: of one eye and direction, else the mean over the four
  std::string population;                // Rate, Silent: "OPN", "EBN.left"
  RateTime time = RateTime::WholeRun;    // Rate
  std::string path;                      // Raster, SameAs: the other file, found from the test file's folder
  std::vector<std::string> populations;  // Raster; none: all
  double begin_s = 0, end_s = 0;         // Raster: half-open; end 0: the whole run
  bool is_exact = false;                 // SameAs: spike for spike
  bool is_rms = false;                   // SameAs: root mean square instead of at every frame
};

struct CircuitTest {
  std::string name;
  Span span;            // of the name
  std::string circuit;  // found from the test file's folder
  Span circuit_span;
  std::vector<std::string> lesions;
  std::vector<std::string> parameters;  // "name=value"
  SimulatedWorld world;
  double settle_s = 0.5;  // what is before is in no rate, silence or travel
  Seeds seeds;
  std::vector<Expectation> expectations;
};

struct TestFile {
  std::string path;
  std::string error;  // one line when the file cannot be read; else empty
  Sources sources;
  Diagnostics diagnostics;
  std::vector<CircuitTest> tests;  // as far as they could be read
};

[[nodiscard]] TestFile read_test_file(const std::string& path);
/// `bytes` as if they were the file `path`.
[[nodiscard]] TestFile read_test_text(const std::string& path, const std::string& bytes);

}  // namespace tectum
