// Values in a circuit file: from text to numbers of the right dimension, or a diagnostic.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/expression/expression.h"
#include "compiler/parse/circuit_decl.h"

namespace tectum {

/// The names that expressions may use, and where problems go.
class Scope {
 public:
  explicit Scope(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  Environment environment;             // the circuit's parameters, and words
  std::vector<Environment> instances;  // by ValueDecl::scope; each has the circuit's behind it
  std::set<std::string> broken;        // declared but wrong: uses of them are not reported again
  /// Names that have a meaning elsewhere, and why not here.
  std::map<std::string, std::string, std::less<>> absent;
  bool knows_all_names = true;   // false when some declarations could not be read: unknown names are then no news
  bool knows_pair_names = true;  // false in a projection whose ends are unknown: the same of places, sides and columns
  bool knows_tick = true;        // false when the circuit's tick is wrong: nothing is then said about whole ticks

  /// Parses and types in `names`; reports and returns nothing when that fails.
  std::optional<TypedExpression> expression(const ValueDecl& value, const Environment& names);
  /// The same, and of dimension `wanted`.
  std::optional<TypedExpression> expression(const ValueDecl& value, const Environment& names, std::string_view key,
                                            const Dimension& wanted);
  /// A constant of this dimension, in coherent units.
  std::optional<double> constant(const ValueDecl& value, std::string_view key, const Dimension& wanted);
  /// A constant of any dimension.
  std::optional<Quantity> quantity(const ValueDecl& value);
  /// A whole plain number in [lowest, highest].
  std::optional<std::uint64_t> whole(const ValueDecl& value, std::string_view key, std::uint64_t lowest,
                                     std::uint64_t highest);
  /// A time that is a whole number of ticks.
  std::optional<std::uint64_t> ticks(const ValueDecl& value, std::string_view key, std::uint64_t tick_ns);
  void report(const ValueDecl& value, const std::vector<ExprError>& errors);
  void report_dimension(const ValueDecl& value, std::string_view key, const Dimension& wanted, const Dimension& found);

  Diagnostics& diagnostics() { return diagnostics_; }
  /// Grows with each error and with each value that gave nothing because its mistake had been reported before.
  [[nodiscard]] std::size_t trouble_count() const { return diagnostics_.error_count() + silent_count_; }
  void keep_silent() { ++silent_count_; }

 private:
  Diagnostics& diagnostics_;
  std::size_t silent_count_ = 0;
};

/// Where a part of the value's text stands in the file.
[[nodiscard]] Span span_in_file(const ValueDecl& value, ExprSpan span);

/// Ticks in `time_ms` when that is a whole number of them (to 1e-6 of a tick).
[[nodiscard]] std::optional<std::uint64_t> whole_ticks(double time_ms, std::uint64_t tick_ns);

/// "20 ms"
[[nodiscard]] std::string shown(double coherent, const Dimension& dimension);

}  // namespace tectum
