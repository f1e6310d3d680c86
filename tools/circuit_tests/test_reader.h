// Reads a test file's JSON; for read_test_file alone.
#pragma once

#include <string>
#include <vector>

#include "compiler/parse/json_tree.h"
#include "compiler/parse/object_reader.h"
#include "compiler/validate/scope.h"
#include "tools/circuit_tests/circuit_test.h"

namespace tectum {

class TestReader {
 public:
  /// Paths are found from `folder`.
  TestReader(const JsonTree& tree, std::string folder, Diagnostics& diagnostics)
      : tree_(tree), folder_(std::move(folder)), scope_(diagnostics) {}

  [[nodiscard]] std::vector<CircuitTest> read();

 private:
  struct Limits {
    double low, high;
  };
  [[nodiscard]] Diagnostics& diagnostics() { return scope_.diagnostics(); }
  [[nodiscard]] std::string path_from(const std::string& name) const;
  [[nodiscard]] const JsonNode& node(JsonId id) const { return tree_[id]; }

  double number(const ValueDecl& value, std::string_view key, const Dimension& dimension, Limits limits,
                double otherwise);
  double number(ObjectReader& in, std::string_view key, const Dimension& dimension, Limits limits, double otherwise);
  std::size_t word(const NameDecl& given, std::string_view what, const std::vector<std::string>& words);
  [[nodiscard]] ValueDecl value_of(JsonId id) const;
  void report_type(JsonId id, std::string_view what, std::string_view expected);

  void read_setting(ObjectReader& in, CircuitTest& test);
  void read_scenario(JsonId id, SimulatedWorld& world);
  void read_seeds(JsonId id, Seeds& seeds);
  [[nodiscard]] std::vector<std::uint64_t> seed_values(JsonId id);
  void read_test(JsonId id, CircuitTest test, std::vector<CircuitTest>& tests);

  // expectation_reader.cpp
  void read_expectations(JsonId id, CircuitTest& test);
  void read_measure(JsonId id, std::string_view section, std::size_t measure, CircuitTest& test);
  void add_bound(JsonId id, Expectation expectation, CircuitTest& test);
  void read_saccade(JsonId id, CircuitTest& test);
  void read_rates(JsonId id, CircuitTest& test);
  void read_eyes(JsonId id, CircuitTest& test);
  void read_raster(JsonId id, CircuitTest& test);
  void read_same_as(JsonId id, CircuitTest& test);

  const JsonTree& tree_;
  std::string folder_;
  Scope scope_;
};

}  // namespace tectum
